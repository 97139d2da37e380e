"""The first import of every command: while the libraries after it are imported, an interrupt just ends it."""

from preshape.command_line.interruption import end_when_interrupted

end_when_interrupted()
