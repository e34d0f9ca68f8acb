#!/usr/bin/python3
"""Converts a PyTorch checkpoint of 3DSSD to the weights file that `mlo run --detector 3dssd` reads.

  scripts/convert_3dssd_checkpoint.py 3dssd.pth 3dssd.safetensors

Known are the parameter names of MMDetection3D and of the two 3DSSDs that exist for OpenPCDet (point_head.vote_layers, as in
SASA, and SA_modules.4.ctr_reg, as in 3DSSD-pytorch-openPCDet). Needs no PyTorch: the file is read as the zip archive that it
is, and nothing in it is executed. What the weights do not say (radii, numbers of samples, ranges, classes) is taken from the
published configuration; --architecture replaces parts of it. See docs/detections.md.
"""

import argparse
import copy
import io
import json
import math
import pickle
import re
import struct
import sys
import zipfile

import numpy as np

FORMAT = "mlo 3dssd 1"
EPSILON = 1e-5  # of batch norms in our file, as OpenPCDet has it


class ConversionError(Exception):
    """Says what is wrong and what to do."""


# ---- The checkpoint -------------------------------------------------------------------------------------------------------

STORAGE_TYPES = {"DoubleStorage": "f8", "FloatStorage": "f4", "HalfStorage": "f2", "BFloat16Storage": "bf16",
                 "LongStorage": "i8", "IntStorage": "i4", "ShortStorage": "i2", "CharStorage": "i1",
                 "ByteStorage": "u1", "BoolStorage": "?"}


class Placeholder:
    """Stands for an object of a class that is not needed; nothing of that class is ever called."""

    def __new__(cls, *_args, **_kwargs):
        return object.__new__(cls)

    def __init__(self, *_args, **_kwargs):
        pass

    def __setstate__(self, _state):
        pass

    def __setitem__(self, _key, _value):
        pass

    def append(self, _value):
        pass

    def extend(self, _values):
        pass


class OrderedDictionary(dict):
    """What collections.OrderedDict becomes: state such as _metadata is left out."""

    def __setstate__(self, _state):
        pass


def rebuild_parameter(data, *_rest):
    return data


class CheckpointUnpickler(pickle.Unpickler):
    """Knows tensors and containers; everything else becomes a placeholder."""

    def __init__(self, file, read_storage):
        super().__init__(file)
        self.read_storage = read_storage

    def find_class(self, module, name):
        if (module, name) == ("collections", "OrderedDict"):
            return OrderedDictionary
        if (module, name) == ("torch._utils", "_rebuild_tensor_v2"):
            return rebuild_tensor
        if (module, name) == ("torch._utils", "_rebuild_parameter"):
            return rebuild_parameter
        if module == "torch" and name in STORAGE_TYPES:
            return name
        return Placeholder

    def persistent_load(self, pid):
        if not isinstance(pid, tuple) or len(pid) != 5 or pid[0] != "storage" or pid[1] not in STORAGE_TYPES:
            raise ConversionError(f"it holds something that is no tensor storage: {pid!r}")
        return self.read_storage(str(pid[2]), STORAGE_TYPES[pid[1]], pid[4])


def rebuild_tensor(storage, offset, size, stride, *_rest):
    """The numbers of a view into a storage, copied."""
    size, stride = tuple(size), tuple(stride)
    last = offset + sum((n - 1) * step for n, step in zip(size, stride))
    if 0 in size:
        return np.zeros(size, storage.dtype)
    if offset < 0 or min(stride, default=0) < 0 or last >= len(storage):
        raise ConversionError(f"a tensor of shape {size} reaches beyond its storage of {len(storage)} numbers")
    strides = tuple(step * storage.itemsize for step in stride)
    return np.lib.stride_tricks.as_strided(storage[offset:], size, strides).copy()


def storage_reader(archive, prefix):
    """Reads the storages of an archive by their names."""
    names = set(archive.namelist())
    order = "<"
    if f"{prefix}byteorder" in names and archive.read(f"{prefix}byteorder") == b"big":
        order = ">"

    def read(key, type_code, count):
        if f"{prefix}data/{key}" not in names:
            raise ConversionError(f"storage {key} is missing in it; it may be cut off")
        data = archive.read(f"{prefix}data/{key}")
        if type_code == "bf16":
            wide = np.frombuffer(data, order + "u2").astype(np.uint32) << 16
            storage = wide.view(np.float32)
        else:
            storage = np.frombuffer(data, order + type_code)
        if len(storage) != count:
            raise ConversionError(f"storage {key} has {len(storage)} numbers instead of {count}")
        return storage

    return read


def read_checkpoint(path):
    """The object that torch.save wrote."""
    if not zipfile.is_zipfile(path):
        raise ConversionError("this is no zip archive: either it is cut off, or written by PyTorch before 1.6; in the latter "
                              "case write it again: torch.save(torch.load(old, map_location='cpu'), new)")
    with zipfile.ZipFile(path) as archive:
        damaged = archive.testzip()
        if damaged:
            raise ConversionError(f"{damaged} in it is damaged; fetch the file again")
        pickles = [name for name in archive.namelist() if name.split("/")[-1] == "data.pkl"]
        if len(pickles) != 1:
            raise ConversionError("it holds no data.pkl, as torch.save writes it")
        prefix = pickles[0][:-len("data.pkl")]
        if f"{prefix}constants.pkl" in archive.namelist():
            raise ConversionError("this is a TorchScript module; give the checkpoint (.pth) it was made of")
        file = io.BytesIO(archive.read(pickles[0]))
        return CheckpointUnpickler(file, storage_reader(archive, prefix)).load()


def find_parameters(checkpoint):
    """The parameters by name, and what MMDetection3D says of itself."""
    if not isinstance(checkpoint, dict):
        raise ConversionError("it is no dictionary of parameters")
    state = checkpoint
    for key in ("model_state", "state_dict"):
        if isinstance(checkpoint.get(key), dict):
            state = checkpoint[key]
    parameters = {str(name).removeprefix("module."): value for name, value in state.items()
                  if isinstance(value, np.ndarray)}
    if not parameters:
        raise ConversionError("it holds no parameters")
    meta = checkpoint.get("meta")
    return parameters, meta if isinstance(meta, dict) else {}


# ---- Architectures: what the weights do not say ---------------------------------------------------------------------------

KITTI_SIZES = {"car": [3.9, 1.6, 1.56], "pedestrian": [0.8, 0.6, 1.73], "cyclist": [1.76, 0.6, 1.73]}
SENSOR_HEIGHT_M = 1.73


def kitti_input(min_z_m, max_z_m):
    """Trained on what KITTI's camera sees of its HDL-64E, with z of the lidar."""
    return {"max_points": 16384, "features": ["intensity"], "max_range_m": 70.0,
            "min_height_m": round(min_z_m + SENSOR_HEIGHT_M, 3), "max_height_m": round(max_z_m + SENSOR_HEIGHT_M, 3),
            "sensor_height_m": SENSOR_HEIGHT_M, "ground": "kept", "half_angle_deg": 41.0, "rings": 64}


def sample(method, count, begin=0, end=-1):
    return {"method": method, "count": count, "from": begin, "to": end}


def scales(radii_m, neighbours, dilated):
    inner = [0.0] + radii_m[:-1] if dilated else [0.0] * len(radii_m)
    return [{"inner_radius_m": i, "radius_m": r, "neighbours": n} for i, r, n in zip(inner, radii_m, neighbours)]


def architecture(layers, max_shift_m, candidate_scales, box_code, input_range):
    return {"batch_norm_eps": EPSILON, "input": input_range, "layers": layers,
            "vote": {"candidates": 256, "max_shift_m": max_shift_m}, "candidate_layer": {"scales": candidate_scales},
            "box_code": box_code}


def published_layers(dilated, last_neighbours):
    """Those of the paper's supplement, which all three have but for details."""
    return [{"samples": [sample("distance", 4096)],
             "scales": scales([0.2, 0.4, 0.8], [32, 32, 64], dilated)},
            {"samples": [sample("feature", 512), sample("distance", 512)],
             "scales": scales([0.4, 0.8, 1.6], [32, 32, 64], dilated)},
            {"samples": [sample("feature", 256, 0, 512), sample("distance", 256, 512, -1)],
             "scales": scales([1.6, 3.2, 4.8], last_neighbours, dilated)}]


def mmdetection3d():
    code = {"center": "metres", "size": "half", "angle_bins": 12, "first_angle_rad": 0.0}
    return architecture(published_layers(True, [32, 32, 32]), [3.0, 3.0, 2.0], scales([4.8, 6.4], [16, 32], False), code,
                        kitti_input(-5.0, 3.0))


def pcdet_vote():
    # sizes are logarithms of metres: class means of 1 m
    code = {"center": "metres", "size": "log_mean", "angle_bins": 12, "first_angle_rad": 0.0}
    return architecture(published_layers(True, [32, 32, 64]), [3.0, 3.0, 2.0], scales([4.8, 6.4], [48, 64], False), code,
                        kitti_input(-3.0, 1.0))


def pcdet_ssd():
    code = {"center": "mean_size", "size": "log_mean", "angle_bins": 12, "first_angle_rad": -math.pi + math.pi / 12}
    return architecture(published_layers(False, [32, 32, 32]), [3.0, 2.0, 3.0], scales([4.8, 6.4], [16, 32], False), code,
                        kitti_input(-3.0, 1.0))


# ---- Names: pattern of theirs, ours ----------------------------------------------------------------------------------------

NUMBER = r"(\d+)"


def in_sequence(theirs, ours):
    """A Sequential of MMCV's ConvModules: layer K's convolution is our 3K, its batch norm 3K + 1."""
    def numbered(offset):
        return lambda m: f"{m.expand(ours)}.{3 * int(m[m.re.groups - 1]) + offset}.{m[m.re.groups]}"

    return [(theirs + NUMBER + r"\.conv\.(weight|bias)", numbered(0)),
            (theirs + NUMBER + r"\.bn\.(weight|bias|running_mean|running_var)", numbered(1))]


def renamed(theirs, ours):
    return [(theirs, lambda m: m.expand(ours))]


HEAD = "bbox_head."
PREDICTION = HEAD + "conv_pred."
BACKBONE = r"backbone_3d.SA_modules.\1"
FAMILIES = {
    "mmdetection3d": {
        "sign": "bbox_head.vote_module.conv_out.weight",
        "architecture": mmdetection3d,
        "names": (in_sequence(rf"backbone\.SA_modules\.{NUMBER}\.mlps\.{NUMBER}\.layer", BACKBONE + r".mlps.\2")
                  + renamed(rf"backbone\.aggregation_mlps\.{NUMBER}\.conv\.(.*)", BACKBONE + r".out_aggregation.0.\2")
                  + renamed(rf"backbone\.aggregation_mlps\.{NUMBER}\.bn\.(.*)", BACKBONE + r".out_aggregation.1.\2")
                  + in_sequence(re.escape(HEAD) + r"vote_module\.vote_conv\.", "point_head.vote_layers")
                  + renamed(re.escape(HEAD) + r"vote_module\.conv_out\.(.*)", r"point_head.vote_layers.last.\1")
                  + in_sequence(re.escape(HEAD) + rf"vote_aggregation\.mlps\.{NUMBER}\.layer", r"point_head.SA_module.mlps.\1")
                  + in_sequence(re.escape(PREDICTION) + r"shared_convs\.layer", "point_head.shared_fc_layer")
                  + in_sequence(re.escape(PREDICTION) + r"cls_convs\.layer", "point_head.cls_layers")
                  + renamed(re.escape(PREDICTION) + r"conv_cls\.(.*)", r"point_head.cls_layers.last.\1")
                  + in_sequence(re.escape(PREDICTION) + r"reg_convs\.layer", "point_head.reg_layers")
                  + renamed(re.escape(PREDICTION) + r"conv_reg\.(.*)", r"point_head.reg_layers.last.\1"))},
    "pcdet-vote": {
        "sign": "point_head.vote_layers.0.weight",
        "architecture": pcdet_vote,
        "names": (renamed(rf"backbone_3d\.SA_modules\.{NUMBER}\.(mlps\..*)", BACKBONE + r".\2")
                  + renamed(rf"backbone_3d\.SA_modules\.{NUMBER}\.aggregation_mlp\.(.*)", BACKBONE + r".out_aggregation.\2")
                  + renamed(r"point_head\.((?:vote_layers|shared_fc_layer|cls_layers|reg_layers|SA_module\.mlps)\..*)",
                            r"point_head.\1"))},
    "pcdet-ssd": {
        "sign": "backbone_3d.SA_modules.4.ctr_reg.weight",
        "architecture": pcdet_ssd,
        "names": (renamed(r"backbone_3d\.SA_modules\.([012])\.((?:mlps|out_aggregation)\..*)", BACKBONE + r".\2")
                  + renamed(r"backbone_3d\.SA_modules\.4\.mlp_modules\.(.*)", r"point_head.vote_layers.\1")
                  + renamed(r"backbone_3d\.SA_modules\.4\.ctr_reg\.(.*)", r"point_head.vote_layers.last.\1")
                  + renamed(r"backbone_3d\.SA_modules\.5\.((?:mlps|out_aggregation)\..*)", r"point_head.SA_module.\1")
                  + renamed(r"point_head\.cls_center_layers\.(.*)", r"point_head.cls_layers.\1")
                  + renamed(r"point_head\.box_center_layers\.(.*)", r"point_head.reg_layers.\1"))},
}
NOT_NEEDED = re.compile(r"(.*\.)?(num_batches_tracked|global_step)")


def family_of(parameters):
    for name, family in FAMILIES.items():
        if family["sign"] in parameters:
            return name
    signs = ", ".join(family["sign"] for family in FAMILIES.values())
    raise ConversionError(f"its parameters are not named like those of a 3DSSD that is known (it has none of {signs})")


def our_names(parameters, family):
    """The parameters under our names; complains of all that have none."""
    ours, unknown = {}, []
    for name, value in parameters.items():
        if NOT_NEEDED.fullmatch(name):
            continue
        for pattern, rename in FAMILIES[family]["names"]:
            match = re.fullmatch(pattern, name)
            if match:
                ours[rename(match)] = value
                break
        else:
            unknown.append(name)
    if unknown:
        raise ConversionError(f"there is no place for these parameters ({family}):\n  " + "\n  ".join(sorted(unknown)))
    return number_last(ours)


def number_last(tensors):
    """Gives convolutions at the end of a sequence, where their number is not in their name, the next one."""
    result = {}
    for name, value in tensors.items():
        if ".last." in name:
            sequence, kind = name.split(".last.")
            name = f"{sequence}.{3 * count_blocks(tensors, sequence)}.{kind}"
        result[name] = value
    return result


def count_blocks(tensors, sequence):
    """Number of blocks (convolution, batch norm) of a sequence, by the highest number that a batch norm has."""
    pattern = re.compile(re.escape(sequence) + r"\.(\d+)\.running_mean")
    numbers = [int(m[1]) for m in map(pattern.fullmatch, tensors) if m]
    return (max(numbers) - 1) // 3 + 1 if numbers else 0


# ---- Shapes ----------------------------------------------------------------------------------------------------------------

def squeezed(tensors):
    """Convolutions of one by one become matrices; all becomes float32."""
    result = {}
    for name, value in tensors.items():
        if name.endswith(".weight") and value.ndim > 2 and all(size == 1 for size in value.shape[2:]):
            value = value.reshape(value.shape[:2])
        result[name] = np.ascontiguousarray(value, np.float32)
    return result


def channels_of(tensors, sequence):
    """Outputs of the blocks of a sequence; where the convolution is missing, those of its batch norm."""
    channels = []
    for block in range(count_blocks(tensors, sequence)):
        weight = tensors.get(f"{sequence}.{3 * block}.weight", tensors.get(f"{sequence}.{3 * block + 1}.running_mean"))
        channels.append(0 if weight is None else int(weight.shape[0]))
    return channels


def count_outputs(tensors, sequence):
    """Of the convolution at the end of a sequence; 0 if it is missing."""
    weight = tensors.get(f"{sequence}.{3 * count_blocks(tensors, sequence)}.weight")
    return 0 if weight is None else int(weight.shape[0])


def fill_channels(tensors, arch):
    """Completes an architecture by what the shapes say."""
    for i, layer in enumerate(arch["layers"]):
        prefix = f"backbone_3d.SA_modules.{i}"
        for s, scale in enumerate(layer["scales"]):
            scale["channels"] = channels_of(tensors, f"{prefix}.mlps.{s}")
        layer["aggregate"] = sum(channels_of(tensors, f"{prefix}.out_aggregation")[-1:])
    arch["vote"]["channels"] = channels_of(tensors, "point_head.vote_layers")
    candidates = arch["candidate_layer"]
    for s, scale in enumerate(candidates["scales"]):
        scale["channels"] = channels_of(tensors, f"point_head.SA_module.mlps.{s}")
    candidates["aggregate"] = sum(channels_of(tensors, "point_head.SA_module.out_aggregation")[-1:])
    arch["head"] = {"shared": channels_of(tensors, "point_head.shared_fc_layer"),
                    "classes": channels_of(tensors, "point_head.cls_layers"),
                    "boxes": channels_of(tensors, "point_head.reg_layers")}


def sequence_shapes(sequence, inputs, channels):
    shapes = {}
    for block, outputs in enumerate(channels):
        shapes[f"{sequence}.{3 * block}.weight"] = (outputs, inputs)
        for kind in ("weight", "bias", "running_mean", "running_var"):
            shapes[f"{sequence}.{3 * block + 1}.{kind}"] = (outputs,)
        inputs = outputs
    return shapes, inputs


def layer_shapes(prefix, inputs, layer):
    """Of grouping layers: one sequence for each scale, joined by one more."""
    shapes, joined = {}, 0
    for s, scale in enumerate(layer["scales"]):
        more, outputs = sequence_shapes(f"{prefix}.mlps.{s}", inputs + 3, scale["channels"])
        shapes.update(more)
        if not scale["channels"]:
            shapes[f"{prefix}.mlps.{s}.0.weight"] = ("any", inputs + 3)
        joined += outputs
    if not layer["aggregate"]:
        return shapes, joined
    more, joined = sequence_shapes(f"{prefix}.out_aggregation", joined, [layer["aggregate"]])
    shapes.update(more)
    return shapes, joined


def branch_shapes(sequence, inputs, channels, outputs):
    shapes, inputs = sequence_shapes(sequence, inputs, channels)
    last = f"{sequence}.{3 * len(channels)}"
    shapes[f"{last}.weight"] = (outputs, inputs)
    shapes[f"{last}.bias"] = (outputs,)
    return shapes


def expected_shapes(arch):
    shapes = {}
    channels = len(arch["input"]["features"])
    for i, layer in enumerate(arch["layers"]):
        more, channels = layer_shapes(f"backbone_3d.SA_modules.{i}", channels, layer)
        shapes.update(more)
    shapes.update(branch_shapes("point_head.vote_layers", channels, arch["vote"]["channels"], 3))
    more, channels = layer_shapes("point_head.SA_module", channels, arch["candidate_layer"])
    shapes.update(more)
    more, channels = sequence_shapes("point_head.shared_fc_layer", channels, arch["head"]["shared"])
    shapes.update(more)
    shapes.update(branch_shapes("point_head.cls_layers", channels, arch["head"]["classes"], len(arch["classes"])))
    shapes.update(branch_shapes("point_head.reg_layers", channels, arch["head"]["boxes"],
                                6 + 2 * arch["box_code"]["angle_bins"]))
    return shapes


def check_shapes(tensors, arch):
    """Complains of all tensors that are missing, too many, of another shape or not finite."""
    expected = expected_shapes(arch)
    problems = []
    for name, shape in sorted(expected.items()):
        if name not in tensors:
            problems.append(f"{name} is missing")
        elif tensors[name].shape != shape:
            problems.append(f"{name} is {tensors[name].shape}, not {shape}")
    for name, value in sorted(tensors.items()):
        convolution_bias = name.endswith(".bias") and f"{name[:-len('.bias')]}.weight" in expected
        if name not in expected and not (convolution_bias and value.shape == tensors[f"{name[:-5]}.weight"].shape[:1]):
            problems.append(f"{name} has no place")
        if not np.isfinite(value).all():
            problems.append(f"{name} holds numbers that are not finite")
    if problems:
        raise ConversionError("the parameters do not make a whole network of this architecture (change it with "
                              "--architecture if yours differs):\n  " + "\n  ".join(problems))


# ---- Conventions -----------------------------------------------------------------------------------------------------------

def last_of(tensors, sequence):
    return f"{sequence}.{3 * count_blocks(tensors, sequence)}"


def scale_residuals(tensors, bins, factor):
    """Changes the unit of the angle residuals, the last rows of the last convolution."""
    for kind in ("weight", "bias"):
        tensors[f"{last_of(tensors, 'point_head.reg_layers')}.{kind}"][6 + bins:] *= factor


def turn_boxes(tensors, bins):
    """From width, length, height and yaw' = -yaw - pi / 2 (MMDetection3D before 1.0) to ours, up to the first angle."""
    back = (-np.arange(bins)) % bins
    rows = np.concatenate([[0, 1, 2, 4, 3, 5], 6 + back, 6 + bins + back])
    for kind in ("weight", "bias"):
        name = f"{last_of(tensors, 'point_head.reg_layers')}.{kind}"
        tensors[name] = np.ascontiguousarray(tensors[name][rows])
        tensors[name][6 + bins:] *= -1.0


def add_epsilon(tensors, epsilon, except_for):
    """Makes batch norms with another epsilon the same with ours: only variance + epsilon counts."""
    for name in tensors:
        if name.endswith(".running_var") and except_for not in name:
            tensors[name] += np.float32(epsilon - EPSILON)


def since_version_1(meta, coordinates):
    """Whether boxes are those of MMDetection3D 1.0 and later."""
    version = str(meta.get("mmdet3d_version", ""))
    if coordinates:
        return coordinates == "since-1.0"
    if re.match(r"[1-9]\d*\.", version):
        return True
    raise ConversionError(f"MMDetection3D changed its boxes in version 1.0, and this checkpoint was written by "
                          f"{version or 'a version that it does not name'}: say --coordinates before-1.0, or since-1.0 if "
                          "it was trained on the branch that became 1.0; with the wrong one cars lie across the road")


def fold_biases(tensors):
    """A bias in front of a batch norm is the same as a smaller mean; our file has none there."""
    for name in [name for name in tensors if name.endswith(".running_mean")]:
        sequence, number = name[:-len(".running_mean")].rsplit(".", 1)
        bias = tensors.pop(f"{sequence}.{int(number) - 1}.bias", None)
        if bias is not None:
            tensors[name] = tensors[name] - bias


def convert_conventions(tensors, arch, family, meta, coordinates):
    """Brings the numbers to our box code and batch norms."""
    bins = arch["box_code"]["angle_bins"]
    fold_biases(tensors)
    if family in ("mmdetection3d", "pcdet-vote"):
        scale_residuals(tensors, bins, 2.0)  # theirs are in whole bins
    if family != "mmdetection3d":
        return
    add_epsilon(tensors, 1e-3, except_for="out_aggregation")  # the joining convolutions have PyTorch's
    if not since_version_1(meta, coordinates):
        turn_boxes(tensors, bins)
        arch["box_code"]["first_angle_rad"] = -math.pi / 2


# ---- The weights file ------------------------------------------------------------------------------------------------------

def write_safetensors(path, tensors, metadata):
    header, offset = {"__metadata__": metadata}, 0
    for name in sorted(tensors):
        end = offset + tensors[name].nbytes
        header[name] = {"data_offsets": [offset, end], "dtype": "F32", "shape": list(tensors[name].shape)}
        offset = end
    text = json.dumps(header, sort_keys=True, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 8)
    with open(path, "wb") as file:
        file.write(struct.pack("<Q", len(text)) + text)
        for name in sorted(tensors):
            file.write(tensors[name].astype("<f4").tobytes())


# ---- The whole -------------------------------------------------------------------------------------------------------------

def merged(base, changes):
    """Objects are merged, everything else is replaced."""
    if not isinstance(base, dict) or not isinstance(changes, dict):
        return copy.deepcopy(changes)
    return {**base, **{key: merged(base.get(key), value) for key, value in changes.items()}}


def complete_architecture(tensors, family, classes, changes):
    arch = FAMILIES[family]["architecture"]()
    count = count_outputs(tensors, "point_head.cls_layers")
    arch["classes"] = classes or list(KITTI_SIZES)[:count]
    arch["mean_sizes_lwh_m"] = [[1.0, 1.0, 1.0] if family == "pcdet-vote" else KITTI_SIZES.get(name, [1.0, 1.0, 1.0])
                                for name in arch["classes"]]
    arch = merged(arch, changes)
    if len(arch["classes"]) != count or len(arch["mean_sizes_lwh_m"]) != count:
        raise ConversionError(f"it tells {count} classes apart; name them in order with --classes, and their mean sizes "
                              "(mean_sizes_lwh_m) in --architecture if they are not KITTI's")
    fill_channels(tensors, arch)
    return arch


def convert(parameters, meta, classes=None, changes=None, coordinates=None):
    """Layout, tensors and architecture of a checkpoint's parameters, as our file has them."""
    family = family_of(parameters)
    tensors = squeezed(our_names(parameters, family))
    arch = complete_architecture(tensors, family, classes, changes or {})
    check_shapes(tensors, arch)
    convert_conventions(tensors, arch, family, meta, coordinates)
    return family, tensors, arch


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("checkpoint", help="what torch.save wrote (.pth)")
    parser.add_argument("out", help="weights file to write (.safetensors)")
    parser.add_argument("--classes", nargs="+", help="in the order of the checkpoint; default: car, pedestrian, cyclist")
    parser.add_argument("--architecture", help="JSON file with what differs from the published configuration")
    parser.add_argument("--coordinates", choices=["before-1.0", "since-1.0"],
                        help="boxes of MMDetection3D; found out where the checkpoint says it")
    args = parser.parse_args()
    try:
        changes = {}
        if args.architecture:
            with open(args.architecture, encoding="utf-8") as file:
                changes = json.load(file)
        parameters, meta = find_parameters(read_checkpoint(args.checkpoint))
        family, tensors, arch = convert(parameters, meta, args.classes, changes, args.coordinates)
        write_safetensors(args.out, tensors, {"format": FORMAT, "architecture": json.dumps(arch, sort_keys=True)})
    except (ConversionError, OSError, ValueError, pickle.UnpicklingError, zipfile.BadZipFile) as error:
        sys.exit(f"{args.checkpoint}: {error}")
    numbers = sum(value.size for value in tensors.values())
    print(f"{args.out}: {numbers} numbers of a 3DSSD in the layout {family}, classes {', '.join(arch['classes'])}")


if __name__ == "__main__":
    main()
