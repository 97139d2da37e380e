"""Templates of the HTML pages, with the filters that all of them share."""

from jinja2 import Environment, PackageLoader, StrictUndefined, Template

from analysis.pages.embedding import embedded_file
from analysis.wording import planner_name


def page_template(name: str) -> Template:
    """A template of the folder `templates`; what it is given is escaped, and a missing value is an error."""
    environment = Environment(
        loader=PackageLoader("analysis.pages"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["embedded"] = embedded_file
    environment.filters["planner"] = planner_name
    environment.filters["percent"] = lambda share: "–" if share is None else f"{100 * share:.0f} %"
    environment.filters["prob"] = lambda prob: "–" if prob is None or prob != prob else f"{prob:.2f}"
    return environment.get_template(name)
