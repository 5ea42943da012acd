"""Fixtures with a stand-in for Isaac Sim; tests import them."""

import pytest

from support.fake_isaac.assets import make_assets
from support.fake_isaac.kit import FakeIsaac
from trundle.sim.isaac import application


@pytest.fixture(scope="session")
def assets(tmp_path_factory):
    folder = tmp_path_factory.mktemp("assets")
    make_assets(folder)
    return folder


@pytest.fixture
def make_fake(monkeypatch, assets):
    """Install a stand-in for Isaac Sim; at the end of the test no application may be left open."""
    made = []

    def make(generation, **settings):
        fake = FakeIsaac(generation, **{"assets": assets, **settings}).install(monkeypatch)
        made.append(fake)
        return fake

    yield make
    for fake in made:
        fake.uninstall()
        assert application.running_application() is None
        assert not fake.runs


@pytest.fixture(params=[5, 6], ids=["5.1", "6.x"])
def fake(request, make_fake):
    return make_fake(request.param)
