"""Columns of Arrow tables as matrices: lists of one length per row, and plain numbers."""

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from faults import Fault


def matrix(column, what, episode=None):
    """A column of numbers, or of lists of equally many numbers, as a matrix with one row per row."""
    array = column.combine_chunks() if isinstance(column, pa.ChunkedArray) else column
    count = len(array)
    width = 1
    while True:
        if isinstance(array, pa.ExtensionArray):
            array = array.storage
        if array.null_count:
            row = int(np.flatnonzero(array.is_null().to_numpy(zero_copy_only=False))[0]) // width
            raise Fault(f"{what} has no value", "fill it in, or take the episode out", episode, row)
        if pa.types.is_fixed_size_list(array.type):
            width *= array.type.list_size
        elif pa.types.is_list(array.type) or pa.types.is_large_list(array.type):
            lengths = pc.list_value_length(array).to_numpy(zero_copy_only=False)
            odd = np.flatnonzero(lengths != lengths[:1])
            if odd.size:
                row = int(odd[0])
                raise Fault(f"{what} has {lengths[row]} numbers, and {lengths[0]} at the start", "record or convert it again", episode, row // width)
            width *= int(lengths[0]) if lengths.size else 1
        else:
            break
        array = array.flatten()
    if not (pa.types.is_floating(array.type) or pa.types.is_integer(array.type) or pa.types.is_boolean(array.type)):
        raise Fault(f"{what} has the type {array.type}, which is no number", "choose another key", episode)
    return array.to_numpy(zero_copy_only=False).reshape(count, width)
