"""Variants of the laboratory: the same configuration under a few other settings."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from hydra import compose
from omegaconf import DictConfig, OmegaConf

from preshape.errors import InputError


@dataclass(frozen=True, eq=False)
class Variant:
    """A laboratory with some settings changed.

    Args:
        name: what it is called.
        overrides: the changes, as they would be typed on the command line.
        laboratory: configuration of the laboratory, without interpolations, so that any process can build it.
    """

    name: str
    overrides: tuple[str, ...]
    laboratory: DictConfig


def compose_variants(
    config_name: str, given: Sequence[str], changes: Mapping[str, Sequence[str]]
) -> list[Variant]:
    """Compose a command's configuration once for each variant.

    Args:
        config_name: the command's configuration.
        given: what the user overrode, for all variants.
        changes: name of a variant -> its overrides, which come after the user's.
    """
    variants = []
    for name, overrides in changes.items():
        cfg = compose(config_name, [*given, *overrides])
        laboratory = OmegaConf.create(OmegaConf.to_container(cfg.laboratory, resolve=True))
        variants.append(Variant(name, tuple(overrides), laboratory))
    return variants


def chosen(changes: Mapping[str, Sequence[str]], names: Sequence[str] | None) -> dict[str, Sequence[str]]:
    """The variants of these names; all for None.

    Raises:
        InputError: for a name that is not there.
    """
    unknown = [name for name in names or () if name not in changes]
    if unknown:
        raise InputError(
            f"There is no variant {unknown[0]}", where="only", fix=f"choose from: {', '.join(changes)}"
        )
    return {name: overrides for name, overrides in changes.items() if names is None or name in names}
