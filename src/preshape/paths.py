"""Where the project lies. Its configuration and shipped data are found there from any current directory."""

from pathlib import Path

from preshape.errors import InputError


def project_root() -> Path:
    """The checkout that this package belongs to.

    Raises:
        InputError: if the package was installed away from its checkout, where no configuration is.
    """
    root = Path(__file__).resolve().parents[2]
    if not (root / "conf").is_dir():
        raise InputError(
            "preshape does not run from its checkout, so its configuration is missing",
            where=root,
            fix="install it from the checkout with `pip install --editable .`",
        )
    return root
