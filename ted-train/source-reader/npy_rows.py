"""Arrays of a .npz file, read some rows at a time: numpy itself would load each one whole."""

import zipfile

import numpy as np
from numpy.lib import format as npy

import arrays
from faults import Fault

SUFFIX = ".npy"


class Npz:
    """The arrays of a file by name."""

    def __init__(self, path):
        self._file = zipfile.ZipFile(path)
        self._arrays = {name[: -len(SUFFIX)]: NpyRows(self._file, name) for name in self._file.namelist() if name.endswith(SUFFIX)}
        if not self._arrays:
            raise Fault("no array in it", "write it with numpy.savez")

    def __getitem__(self, name):
        return self._arrays[name]

    def __contains__(self, name):
        return name in self._arrays

    def __iter__(self):
        return iter(self._arrays)


class NpyRows:
    """One array. Slices that go forward are read as they come; one that goes backward begins anew."""

    def __init__(self, archive, name):
        self._archive = archive
        self._name = name
        self._stream = None
        self._row = 0
        self._whole = None
        with archive.open(name) as stream:
            self.shape, self._fortran, self.dtype = read_header(stream, name)

    def __len__(self):
        return self.shape[0] if self.shape else 0

    def __getitem__(self, rows):
        begin, stop, step = rows.indices(len(self))
        if self._fortran and len(self.shape) > 1:
            # Columns lie behind one another, so that there are no rows to read one by one.
            if self._whole is None:
                with self._archive.open(self._name) as stream:
                    self._whole = npy.read_array(stream, allow_pickle=False)
            return self._whole[rows]
        if begin < self._row or self._stream is None:
            self._stream = self._archive.open(self._name)
            read_header(self._stream, self._name)
            self._row = 0
        size = self.dtype.itemsize * arrays.width_of(self.shape[1:])
        self._skip((begin - self._row) * size)
        self._row = max(stop, begin)
        data = self._read((self._row - begin) * size)
        return np.frombuffer(data, self.dtype).reshape(self._row - begin, *self.shape[1:])[::step]

    def _skip(self, count):
        while count:
            read = len(self._read(min(count, 1 << 20)))
            count -= read

    def _read(self, count):
        data = self._stream.read(count)
        if len(data) != count:
            raise Fault(f"{self._name} ends before its last row", "write the file again")
        return data


def read_header(stream, name):
    try:
        version = npy.read_magic(stream)
        read = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
        shape, fortran, dtype = read(stream)
    except ValueError as error:
        raise Fault(f"{name} is no numpy array: {error}", "write the file again with numpy.savez") from error
    if dtype.hasobject:
        raise Fault(f"{name} holds Python objects", "write plain numbers: one array for each column, or for all of them")
    return shape, fortran, dtype
