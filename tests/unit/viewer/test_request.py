import pytest

from preshape.errors import InputError
from preshape.viewer.request import Request


@pytest.mark.parametrize(
    ("request_", "message"),
    [
        (Request("two_finger", has_body=False, has_palm_poses=False, wants_plan=False), "no robot to show"),
        (Request("baxter", has_body=True, has_palm_poses=False, wants_plan=True), "rectangles"),
    ],
)
def test_what_the_viewer_cannot_show_is_refused(request_: Request, message: str) -> None:
    with pytest.raises(InputError, match=message):
        request_.check()


def test_the_rest_is_shown() -> None:
    Request("baxter", has_body=True, has_palm_poses=False, wants_plan=False).check()
    Request("lbr4_allegro", has_body=True, has_palm_poses=True, wants_plan=True).check()
