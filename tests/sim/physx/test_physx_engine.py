"""Where PhysX cannot run, one message says what is missing. None of these tests needs it."""

import importlib.metadata
import platform
import resource
import subprocess
import sys

import pytest

from trundle import extras
from trundle.errors import InputError, MissingExtraError
from trundle.sim import simulate
from trundle.sim.physx import engine
from trundle.worlds import World


@pytest.fixture
def machine(monkeypatch, tmp_path):
    """A machine that can run PhysX, with the extra; single facts of it are then changed."""
    (tmp_path / "cpuinfo").write_text("flags\t\t: fpu sse2 avx avx2\n")
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setattr(platform, "machine", lambda: "x86_64")
    monkeypatch.setattr(platform, "libc_ver", lambda: ("glibc", "2.39"))
    monkeypatch.setattr(engine, "_CPU_INFO", tmp_path / "cpuinfo")
    monkeypatch.setattr(engine, "check_extra", lambda *_: None)
    monkeypatch.setattr(importlib.metadata, "version", lambda _: "0.7.0.74035321")
    return monkeypatch


def test_a_machine_that_can(machine):
    assert engine.check_installation() == "0.7.0.74035321"


@pytest.mark.parametrize(
    ("system", "processor", "found"),
    [("darwin", "arm64", "macOS on arm64"), ("win32", "AMD64", "Windows on AMD64"), ("linux", "aarch64", "aarch64")],
)
def test_another_system_or_processor(machine, system, processor, found):
    machine.setattr(sys, "platform", system)
    machine.setattr(platform, "machine", lambda: processor)
    with pytest.raises(InputError, match=f"runs on Linux with an x86-64 processor; this is .*{found}: use backend"):
        simulate(World("empty", ()), "nova_carter", backend="physx")


def test_an_old_glibc(machine):
    machine.setattr(platform, "libc_ver", lambda: ("glibc", "2.31"))
    with pytest.raises(InputError, match=r"needs glibc 2\.35 or later, as in Ubuntu 22\.04; this is 2\.31: use"):
        engine.check_installation()


def test_no_glibc(machine):
    machine.setattr(platform, "libc_ver", lambda: ("", ""))
    with pytest.raises(InputError, match="needs glibc, which this Linux does not have"):
        engine.check_installation()


def test_a_processor_without_avx(machine, tmp_path):
    (tmp_path / "cpuinfo").write_text("processor : 0\nflags\t\t: fpu sse2 ssse3\n")
    with pytest.raises(InputError, match="needs a processor with AVX"):
        engine.check_installation()


@pytest.mark.parametrize("version", ["0.6.2.1", "0.8.0.1", "1.0"])
def test_another_version(machine, version):
    machine.setattr(importlib.metadata, "version", lambda _: version)
    with pytest.raises(
        InputError, match=rf"ovphysx {version} is installed, and backend physx is written for 0\.7\.x; .*physx"
    ):
        engine.check_installation()


def test_a_limit_of_the_address_space(machine):
    machine.setattr(resource, "getrlimit", lambda _: (2 << 30, 2 << 30))
    with pytest.raises(InputError, match=r"this process may have 2\.0 GB: raise the limit \(ulimit -v\)"):
        engine.check_installation()


def test_a_missing_extra(machine):
    machine.setattr(engine, "check_extra", extras.check_extra)
    machine.setattr("importlib.util.find_spec", lambda _: None)
    with pytest.raises(MissingExtraError, match=r"350 MB, under NVIDIA's licence\) needs ovphysx, .*\[physx\]"):
        engine.check_installation()


def test_it_is_imported_only_where_it_is_used():
    code = "import sys, trundle.sim.physx.engine; print({'ovphysx', 'ovstage', 'warp', 'pxr'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "set()\n"
