"""What several tests use."""

import itertools
import os
import pathlib
import socket

import pytest


def has_ports(domain):
    """Does a socket hold a UDP port of the domain still, say of a server that is being ended?"""
    first = 7400 + 250 * domain
    sockets = pathlib.Path("/proc/net/udp").read_text().splitlines()[1:]
    return any(first <= int(line.split()[1].split(":")[1], 16) < first + 250 for line in sockets)


@pytest.fixture
def domain():
    """A DDS domain that no other test of this machine has: its name is taken as tests/network/domain.cpp takes it."""
    for tries in itertools.count():
        number = 1 + (os.getpid() + tries) % 100
        with socket.socket(socket.AF_UNIX) as name:
            try:
                name.bind(f"\0mortise-test-domain-{number}")
            except OSError:
                continue
            if has_ports(number):
                continue
            yield number
            return
