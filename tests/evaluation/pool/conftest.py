import pytest

from support.pools import make_pool


@pytest.fixture(scope="module")
def pool():
    """Of one worker: what a job breaks would show in the next."""
    with make_pool() as pool:
        yield pool
