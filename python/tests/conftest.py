# SPDX-License-Identifier: MIT
import os

import pytest

import alcap


@pytest.fixture(scope='session')
def source():
    """The repository, for tests that read its files."""
    folder = os.environ.get('ALCAP_SOURCE_DIR')
    if folder is None:
        pytest.skip('ALCAP_SOURCE_DIR is not set: scripts/python.sh sets it')
    return folder


@pytest.fixture(scope='session')
def sphere():
    return alcap.Surface(*alcap.shapes.icosphere(3))


@pytest.fixture(scope='session')
def bumpy():
    return alcap.Surface(*alcap.shapes.bumpy_sphere(3, 0.3, 4.0))


@pytest.fixture(scope='session')
def cross(bumpy):
    return alcap.smoothest_field(bumpy, n=4)
