"""What commonly goes wrong on a machine, and its fix.

Imports the standard library only, because it must run where nothing else does.
"""
