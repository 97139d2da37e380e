"""What every command does around its own work: compose the configuration, set up, and end understandably."""

import os
import sys
from collections.abc import Callable
from functools import wraps
from typing import NoReturn

import hydra
from hydra.core.hydra_config import HydraConfig
from hydra.errors import ConfigCompositionException, OverrideParseException
from hydra.types import RunMode
from omegaconf import DictConfig, OmegaConf
from omegaconf.errors import InterpolationKeyError

from preshape.command_line.composition import check_composition, chosen_option, option_or
from preshape.command_line.interruption import end_interrupted, raise_interrupts
from preshape.errors import InputError, bad_input_behind
from preshape.paths import project_root
from preshape.provenance import TYPED_COMMAND, typed_command
from preshape.sweeps.sweep_folders import sweep_group

EXIT_BAD_INPUT = 2

OmegaConf.register_new_resolver("project_root", lambda: str(project_root()), replace=True)
OmegaConf.register_new_resolver("sweep_group", sweep_group, replace=True)
OmegaConf.register_new_resolver("choice", chosen_option, replace=True)
OmegaConf.register_new_resolver("option_or", option_or, replace=True)


def entry_point(config_name: str) -> Callable[[Callable[[DictConfig], None]], Callable[[], None]]:
    """Make a command of `main(cfg)`, configured by `conf/<config_name>.yaml` and the command line.

    The current directory stays as it is. A composition that does not fit is refused before `main` runs.
    Whatever the user got wrong ends as one message with exit status 2, an interrupt with status 130; anything
    else is a defect and keeps its traceback.
    """

    def decorate(main: Callable[[DictConfig], None]) -> Callable[[], None]:
        begun = False

        @wraps(main)
        def job(cfg: DictConfig) -> None:
            nonlocal begun
            begun = True
            _run_job(main, cfg)

        @wraps(main)
        def command() -> None:
            # Hydra would otherwise print its own report of every exception and exit before we see it.
            os.environ["HYDRA_FULL_ERROR"] = "1"
            os.environ[TYPED_COMMAND] = typed_command()
            try:
                raise_interrupts()
                conf = str(project_root() / "conf")
                hydra.main(config_path=conf, config_name=config_name, version_base="1.3")(job)()
            except InputError as error:
                _refuse(str(error))
            except (ConfigCompositionException, OverrideParseException) as error:
                _refuse(_misuse(error))
            except OSError as error:
                refusal = bad_input_behind(error)
                if not begun and error.filename is not None:
                    problem = f"The folder of the run cannot be made: {error.strerror}"
                    fix = "choose another place with paths.outputs=DIR"
                    refusal = InputError(problem, where=error.filename, fix=fix)
                if refusal is None:
                    raise
                _refuse(str(refusal))
            except (KeyboardInterrupt, SystemExit) as end:
                # Lightning answers an interrupt with an exit of its own
                if isinstance(end, SystemExit) and not isinstance(end.__context__, KeyboardInterrupt):
                    raise
                sys.stdout.flush()
                end_interrupted()

        return command

    return decorate


def _run_job(main: Callable[[DictConfig], None], cfg: DictConfig) -> None:
    try:
        check_composition(cfg)
        main(cfg)
    except Exception as error:
        bad_input = _misfit(error) if isinstance(error, InterpolationKeyError) else bad_input_behind(error)
        if bad_input is None:
            raise
        if HydraConfig.get().mode is RunMode.MULTIRUN:  # the sweep says which of its jobs it was
            raise bad_input from None
        _refuse(str(bad_input))


def _misfit(error: InterpolationKeyError) -> InputError:
    """What a chosen part lacks that another one refers to."""
    return InputError(
        f"The chosen parts do not fit together: {str(error).splitlines()[0]}",
        where=str(error.full_key or "the chosen settings"),
        fix="choose other parts; `--cfg job` shows what they are made of",
    )


def _misuse(error: ConfigCompositionException | OverrideParseException) -> str:
    """What Hydra says about the command line, without its list of folders searched."""
    if isinstance(error, OverrideParseException):
        return f"{error.override!r} cannot be read as KEY=VALUE: {error.message.splitlines()[0]}"
    said = str(error).split("\nConfig search path")[0].strip()
    reason = "" if error.__cause__ is None else str(error.__cause__).splitlines()[0]
    return said if reason in said else f"{said}\n{reason}"


def _refuse(message: str) -> NoReturn:
    sys.stderr.write(f"ERROR: {message}\n")
    sys.exit(EXIT_BAD_INPUT)
