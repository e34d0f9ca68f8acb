"""Writes what torch.save writes, without PyTorch: a zip archive with a pickle (protocol 2) and raw storages."""

import pickle
import struct
import zipfile

import numpy as np

STORAGES = {"float32": "FloatStorage", "float64": "DoubleStorage", "float16": "HalfStorage", "int64": "LongStorage"}


def text(value):
    data = value.encode()
    return b"X" + struct.pack("<I", len(data)) + data


def integer(value):
    return b"J" + struct.pack("<i", value)


def integers(values):
    return b"(" + b"".join(integer(value) for value in values) + b"t"


def global_name(module, name):
    return b"c" + f"{module}\n{name}\n".encode()


class Writer:
    """Turns values into opcodes; keeps the storages."""

    def __init__(self):
        self.storages = []

    def tensor(self, value, offset=0, stride=None):
        """torch._utils._rebuild_tensor_v2(storage, offset, size, stride, False, OrderedDict())"""
        value = np.asarray(value)
        if stride is None:
            stride = [step // value.itemsize for step in np.zeros(value.shape, value.dtype).strides]
        key = str(len(self.storages))
        self.storages.append(np.concatenate([np.zeros(offset, value.dtype), value.ravel()]).tobytes())
        storage = (b"(" + text("storage") + global_name("torch", STORAGES[value.dtype.name]) + text(key) + text("cpu")
                   + integer(offset + value.size) + b"tQ")
        return (global_name("torch._utils", "_rebuild_tensor_v2") + b"(" + storage + integer(offset) + integers(value.shape)
                + integers(stride) + b"\x89" + self.ordered({}) + b"tR")

    def ordered(self, values):
        """collections.OrderedDict, with the state that a module's state_dict has."""
        state = b"}" + b"(" + text("_metadata") + b"}" + b"u"
        return global_name("collections", "OrderedDict") + b")R" + self.items(values) + (state + b"b" if values else b"")

    def items(self, values):
        return b"(" + b"".join(text(key) + self.value(value) for key, value in values.items()) + b"u" if values else b""

    def value(self, value):
        if isinstance(value, bytes):
            return value  # opcodes already
        if isinstance(value, str):
            return text(value)
        if isinstance(value, int):
            return integer(value)
        if isinstance(value, dict):
            return b"}" + self.items(value)
        return self.tensor(value)


def save(path, make, byteorder=b"little", prefix="archive/"):
    """@param make  gives the opcodes of the checkpoint, from a Writer"""
    writer = Writer()
    data = b"\x80\x02" + make(writer) + b"."
    assert pickle.PROTO == data[:1]
    with zipfile.ZipFile(path, "w", zipfile.ZIP_STORED) as archive:
        archive.writestr(prefix + "data.pkl", data)
        archive.writestr(prefix + "byteorder", byteorder)
        for key, storage in enumerate(writer.storages):
            archive.writestr(f"{prefix}data/{key}", storage)
        archive.writestr(prefix + "version", b"3\n")
