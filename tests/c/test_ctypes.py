# SPDX-License-Identifier: MIT
"""test_ctypes.py LIBRARY: the C interface by the standard library alone: a field on an octahedron."""
import ctypes
import json
import sys


class Error(ctypes.Structure):
    _fields_ = [('size', ctypes.c_uint32), ('status', ctypes.c_int32), ('count', ctypes.c_int64),
                ('first_count', ctypes.c_int32), ('first', ctypes.c_int32 * 16), ('element', ctypes.c_char * 16),
                ('defect', ctypes.c_char * 32), ('field', ctypes.c_char * 64), ('message', ctypes.c_char * 1024)]


library = ctypes.CDLL(sys.argv[1])
library.alcap_run_report.restype = ctypes.c_char_p
library.alcap_run_report.argtypes = library.alcap_run_free.argtypes = [ctypes.c_void_p]
library.alcap_surface_free.argtypes = [ctypes.c_void_p]
V = [1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1]
F = [0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5]
points, faces = (ctypes.c_double * len(V))(*V), (ctypes.c_int32 * len(F))(*F)
error = Error(size=ctypes.sizeof(Error))
surface, run = ctypes.c_void_p(), ctypes.c_void_p()


def create(count):
    return library.alcap_surface_create(points, ctypes.c_int64(6), faces, ctypes.c_int64(count), ctypes.byref(surface),
                                        ctypes.byref(error))


assert create(8) == 0, error.message
assert library.alcap_field_solve(surface, None, ctypes.byref(run), ctypes.byref(error)) == 0, error.message
report = json.loads(library.alcap_run_report(run))
assert report['ok'] and report['singularities']['index_sum'] == 8, report  # 4 times the Euler characteristic
library.alcap_run_free(run)
library.alcap_surface_free(surface)
faces[0] = 77
assert create(8) == 2 and error.defect == b'index_out_of_range' and error.first[0] == 0
print('ok:', error.message.decode())
