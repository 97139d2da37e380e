"""Every option of every configuration group is commented, composes with its commands, and builds."""

import re
import shlex
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import pytest
import trimesh
import yaml
from hydra import compose, initialize_config_dir
from hydra.errors import ConfigCompositionException
from hydra.utils import instantiate
from omegaconf import DictConfig, OmegaConf

import preshape.command_line.entry_point  # noqa: F401 - registers the resolvers
from preshape.command_line.composition import missing_keys

ROOT = Path(__file__).parents[2]
CONF = ROOT / "conf"
HYDRAS_OWN_KEYS = {"_target_", "_convert_", "_partial_", "_recursive_", "_args_", "defaults"}
SCRIPTS = [path for folder in ("src", "sim", "analysis") for path in sorted((ROOT / folder).glob("*.py"))]
DOCUMENTS = [ROOT / "Makefile", ROOT / "dvc.yaml", ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
COMMANDS = [
    command
    for script in SCRIPTS
    for command in re.findall(r'^@entry_point\("(\w+)"\)', script.read_text(encoding="utf-8"), re.MULTILINE)
]
GROUPS = sorted(path for path in CONF.iterdir() if path.is_dir() and any(path.glob("*.yaml")))


def compose_command(command: str, *overrides: str, with_hydra: bool = False) -> DictConfig:
    with initialize_config_dir(str(CONF), version_base="1.3"):
        return compose(command, list(overrides), return_hydra_config=with_hydra)


def places_of_groups() -> dict[tuple[str, str], list[str]]:
    """Where a command has an option of a group: `planner`, or `planner@planners.inference` and others."""
    places = defaultdict(list)
    for command in COMMANDS:
        for key in compose_command(command, with_hydra=True).hydra.runtime.choices:
            places[command, key.split("@")[0]].append(key)
    return places


PLACES = places_of_groups()
CHOICES = sorted(
    (command, group.name, option.stem)
    for command in COMMANDS
    for group in GROUPS
    if (command, group.name) in PLACES
    for option in group.glob("*.yaml")
)
"""Every (command, group, option) that a user can choose."""
EXPERIMENT = "experiment"


@pytest.fixture(scope="module")
def mesh_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One box, for objects=mesh_folder and for objects=bigbird."""
    folder = tmp_path_factory.mktemp("meshes")
    (folder / "box" / "meshes").mkdir(parents=True)
    for path in (folder / "box.obj", folder / "box" / "meshes" / "poisson.ply"):
        trimesh.creation.box((0.05, 0.06, 0.1)).export(path)
    return folder


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("cache")


@pytest.fixture(scope="module")
def built() -> set[str]:
    """Settings of the parts that were built: many commands have the same ones."""
    return set()


def buildable(node: object) -> Iterator[DictConfig]:
    """The outermost parts that `instantiate` would build."""
    if not isinstance(node, DictConfig) or node._is_none() or node._is_missing():
        return
    if "_target_" in node:
        yield node
        return
    for key in node:
        if not OmegaConf.is_missing(node, key):
            yield from buildable(node[key])


def uncommented_keys(path: Path) -> Iterator[str]:
    text = path.read_text(encoding="utf-8")
    lines = text.splitlines()

    def walk(node: yaml.Node | None) -> Iterator[str]:
        if not isinstance(node, yaml.MappingNode):
            return
        for key, value in node.value:
            line = key.start_mark.line
            above = lines[line - 1].strip() if line else ""
            if key.value not in HYDRAS_OWN_KEYS and not above.startswith("#") and " # " not in lines[line]:
                yield f"{path.relative_to(ROOT)}:{line + 1} {key.value}"
            yield from walk(value)

    yield from walk(yaml.compose(text, Loader=yaml.SafeLoader))


@pytest.mark.parametrize("path", sorted(CONF.rglob("*.yaml")), ids=lambda path: str(path.relative_to(CONF)))
def test_every_key_is_commented(path: Path) -> None:
    assert list(uncommented_keys(path)) == []


def test_no_option_is_unreachable() -> None:
    reachable = {(group, option) for _, group, option in CHOICES}
    assert {(group.name, path.stem) for group in GROUPS for path in group.glob("*.yaml")} == reachable


@pytest.mark.parametrize("option", sorted({option for _, key, option in CHOICES if key == EXPERIMENT}))
def test_every_experiment_composes_with_a_command(option: str) -> None:
    def composes(command: str) -> bool:
        try:
            return compose_command(command, f"{EXPERIMENT}={option}") is not None
        except ConfigCompositionException:  # made for another command
            return False

    assert any(composes(command) for command, key, known in CHOICES if (key, known) == (EXPERIMENT, option))


@pytest.mark.parametrize(
    ("command", "group", "option"), [choice for choice in CHOICES if choice[1] != EXPERIMENT]
)
def test_every_option_composes_and_builds(
    command: str, group: str, option: str, mesh_folder: Path, cache: Path, built: set[str]
) -> None:
    places = PLACES[command, group]
    overrides = [*(f"{place}={option}" for place in places), f"paths.cache={cache}"]
    given = {"objects.root": mesh_folder, "report.root": cache, "dataset.root": cache}
    cfg = compose_command(command, *overrides)
    if missing := set(missing_keys(OmegaConf.to_container(cfg))) & set(given):
        cfg = compose_command(command, *overrides, *(f"{key}={given[key]}" for key in missing))
    for part in (part for place in places for part in buildable(OmegaConf.select(cfg, place.split("@")[-1]))):
        settings = str(OmegaConf.to_container(part, resolve=True))
        if settings not in built:
            assert instantiate(part) is not None
            built.add(settings)


def documented_commands() -> Iterator[tuple[str, str]]:
    """(command, overrides) of every call of a command in the documents.

    Calls that choose an example whose file is only on the page are run by `test_document_examples`.
    """
    for document in DOCUMENTS:
        text = document.read_text(encoding="utf-8").replace("\\\n", " ")
        named = re.findall(r"^`?(?:.* )?`conf/(\w+)/(\w+)\.yaml`:$", text, re.MULTILINE)
        examples = [f"={name}" for group, name in named if not (CONF / group / f"{name}.yaml").exists()]
        for command, overrides in re.findall(r"\b(?:src|sim|analysis)/(\w+)\.py([^`#|&\n]*)", text):
            if command in COMMANDS and not any(example in overrides for example in examples):
                yield command, overrides.strip()


def first_of_sweep(option: str) -> str:
    """`shard=0` of `shard=0,1` and of `shard=range(0,64)`; lists stay as they are."""
    return re.sub(r"=(?:range\()?([^,\[\]]+),[^\[\]]*$", r"=\1", option)


@pytest.mark.parametrize(("command", "overrides"), sorted(set(documented_commands())))
def test_documented_commands_compose(command: str, overrides: str) -> None:
    options = [first_of_sweep(word) for word in shlex.split(overrides) if "=" in word]
    assert compose_command(command, *options) is not None
