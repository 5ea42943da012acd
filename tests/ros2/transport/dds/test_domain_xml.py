"""What Cyclone DDS is configured with."""

from xml.etree import ElementTree

from trundle.ros2.transport.dds.node import domain_xml
from trundle.ros2.transport.domain import Settings


def test_on_localhost_it_uses_the_loopback_alone() -> None:
    xml = ElementTree.fromstring(domain_xml(Settings()))
    (interface,) = xml.iter("NetworkInterface")
    assert interface.attrib == {"address": "127.0.0.1", "multicast": "true"}
    assert [peer.get("address") for peer in xml.iter("Peer")] == ["localhost"]
    assert xml.findtext(".//AllowMulticast") == "spdp"


def test_in_the_subnet_it_looks_for_the_peers_that_are_named() -> None:
    xml = ElementTree.fromstring(domain_xml(Settings(range="subnet", static_peers=("10.0.0.2", "robot.local"))))
    (interface,) = xml.iter("NetworkInterface")
    assert interface.attrib == {"autodetermine": "true"}
    assert [peer.get("address") for peer in xml.iter("Peer")] == ["10.0.0.2", "robot.local"]


def test_kilteds_type_information_is_ignored() -> None:
    xml = ElementTree.fromstring(domain_xml(Settings()))
    assert xml.findtext(".//Compatibility/IgnoreTypeInformation") == "1.15"


def test_the_users_configuration_comes_last() -> None:
    xml = domain_xml(Settings(range="subnet", cyclonedds_uri="file:///etc/cyclonedds.xml"))
    assert xml.endswith("</CycloneDDS>,file:///etc/cyclonedds.xml")
