"""Settings from options and from the variables that ROS reads."""

import pytest

from trundle.errors import InputError, UnknownNameError
from trundle.ros2.transport.domain import read_settings


def test_without_options_and_variables_it_is_domain_0_of_this_machine() -> None:
    settings = read_settings(environ={})
    assert (settings.distro, settings.domain, settings.range, settings.notes) == ("jazzy", 0, "localhost", ())
    assert settings.given == frozenset()


def test_options_go_before_variables() -> None:
    environ = {"ROS_DISTRO": "humble", "ROS_DOMAIN_ID": "7"}
    assert read_settings(environ=environ).domain == 7
    assert read_settings(environ=environ).distro == "humble"
    settings = read_settings(environ=environ, domain=9, distro="kilted")
    assert (settings.domain, settings.distro, settings.given) == (9, "kilted", {"domain", "distro"})


def test_a_distribution_that_is_not_known_is_taken_for_the_nearest() -> None:
    settings = read_settings(environ={"ROS_DISTRO": "iron"})
    assert settings.distro == "jazzy"
    assert "treated as jazzy" in settings.notes[0]
    assert read_settings(environ={"ROS_DISTRO": "iron"}, distro="humble").notes == ()


def test_an_empty_variable_is_one_that_is_not_set() -> None:
    environ = dict.fromkeys(("ROS_DOMAIN_ID", "ROS_DISTRO", "ROS_LOCALHOST_ONLY", "ROS_AUTOMATIC_DISCOVERY_RANGE"), "")
    assert read_settings(environ=environ) == read_settings(environ={})


@pytest.mark.parametrize(
    "environ",
    [{}, {"ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"}, {"ROS_LOCALHOST_ONLY": "0"}, {"ROS_STATIC_PEERS": "10.0.0.2"}],
)
def test_only_the_option_leaves_this_machine(environ: dict[str, str]) -> None:
    environ = {**environ, "CYCLONEDDS_URI": "<CycloneDDS/>"}
    settings = read_settings(environ=environ)
    assert (settings.range, settings.static_peers, settings.cyclonedds_uri) == ("localhost", (), "")
    assert any("CYCLONEDDS_URI is not used" in note for note in settings.notes)
    wide = read_settings(environ=environ, range_="subnet")
    assert (wide.range, wide.cyclonedds_uri, wide.notes) == ("subnet", "<CycloneDDS/>", ())


def test_what_the_environment_asks_for_and_does_not_get_is_stated() -> None:
    (note,) = read_settings(environ={"ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"}).notes
    assert "--range subnet" in note
    (note,) = read_settings(environ={"ROS_LOCALHOST_ONLY": "1"}, range_="subnet").notes
    assert note == "ROS_LOCALHOST_ONLY=1 is overruled by --range subnet"
    (note,) = read_settings(environ={"RMW_IMPLEMENTATION": "rmw_zenoh_cpp"}).notes
    assert "--transport rclpy" in note


def test_static_peers_are_addresses_between_semicolons() -> None:
    environ = {"ROS_STATIC_PEERS": "192.168.1.5; robot.local;fe80::1%eth0;"}
    peers = read_settings(environ=environ, range_="subnet").static_peers
    assert peers == ("192.168.1.5", "robot.local", "fe80::1%eth0")


@pytest.mark.parametrize(
    ("environ", "named"),
    [
        ({"ROS_DOMAIN_ID": "233"}, "ROS_DOMAIN_ID=233"),
        ({"ROS_DOMAIN_ID": "-1"}, "ROS_DOMAIN_ID=-1"),
        ({"ROS_DOMAIN_ID": "ten"}, "ROS_DOMAIN_ID=ten"),
        ({"ROS_DOMAIN_ID": "²"}, "ROS_DOMAIN_ID=²"),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "subnet"}, "ROS_AUTOMATIC_DISCOVERY_RANGE=subnet"),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF"}, "no program would find trundle"),
        ({"ROS_LOCALHOST_ONLY": "true"}, "ROS_LOCALHOST_ONLY=true"),
        ({"ROS_DISTRO": "noetic"}, "--distro"),
    ],
)
def test_a_variable_that_cannot_be_used_is_named(environ: dict[str, str], named: str) -> None:
    with pytest.raises(InputError, match=named):
        read_settings(environ=environ)


def test_peers_that_are_no_addresses_are_refused() -> None:
    with pytest.raises(InputError, match="ROS_STATIC_PEERS"):
        read_settings(environ={"ROS_STATIC_PEERS": "a,b"}, range_="subnet")
    with pytest.raises(InputError, match="ROS_STATIC_PEERS"):
        read_settings(environ={"ROS_STATIC_PEERS": "<x/>"}, range_="subnet")


def test_options_that_cannot_be_used_are_refused() -> None:
    with pytest.raises(InputError, match="--domain 500"):
        read_settings(environ={}, domain=500)
    with pytest.raises(UnknownNameError, match="range"):
        read_settings(environ={}, range_="lan")  # pyright: ignore[reportArgumentType]
    with pytest.raises(UnknownNameError, match="distribution"):
        read_settings(environ={}, distro="iron")  # pyright: ignore[reportArgumentType]


def test_a_domain_among_the_outgoing_ports_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.platform", "linux")
    assert "215 to 232" in " ".join(read_settings(environ={}, domain=150).notes)
    assert read_settings(environ={}, domain=215).notes == ()


def test_programs_started_by_us_join_the_same_domain_and_range() -> None:
    settings = read_settings(environ={"ROS_DOMAIN_ID": "3", "ROS_LOCALHOST_ONLY": "0"})
    assert settings.environment() == {
        "ROS_DOMAIN_ID": "3",
        "ROS_LOCALHOST_ONLY": "",
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "ROS_STATIC_PEERS": "",
    }
    humble = read_settings(environ={}, distro="humble").environment()
    assert (humble["ROS_LOCALHOST_ONLY"], humble["ROS_AUTOMATIC_DISCOVERY_RANGE"]) == ("1", "")
