"""What several tests use."""

import itertools
import os
import socket

import pytest


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
            yield number
            return
