#!/usr/bin/python3
"""scripts/convert_3dssd_checkpoint.py on checkpoints that are made here, in all layouts that it knows."""

import importlib.util
import json
import math
import os
import pickle
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

try:
    import numpy as np
except ImportError:
    print("skipped: python3-numpy is missing (scripts/install_dependencies.sh build)")
    sys.exit(77)

import torch_file

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "convert_3dssd_checkpoint.py"
spec = importlib.util.spec_from_file_location("convert_3dssd_checkpoint", SCRIPT)
converter = importlib.util.module_from_spec(spec)
spec.loader.exec_module(converter)

BINS = 12
SCALE_CHANNELS = [[[4, 5], [4, 6], [4, 7]], [[5, 6], [5, 7], [5, 8]], [[6, 7], [6, 8], [6, 9]]]
JOINED = [8, 9, 10]
CANDIDATE_CHANNELS = [[7, 11], [7, 12]]


class Maker:
    """Parameters with numbers that differ everywhere; variances are positive."""

    def __init__(self, dimensions):
        self.random = np.random.default_rng(1)
        self.dimensions = dimensions  # of a convolution's weight
        self.parameters = {}

    def numbers(self, name, *shape):
        self.parameters[name] = self.random.uniform(0.5, 2.0, shape).astype(np.float32)

    def convolution(self, name, inputs, outputs, bias, dimensions=None):
        self.numbers(f"{name}.weight", outputs, inputs, *[1] * ((dimensions or self.dimensions) - 2))
        if bias:
            self.numbers(f"{name}.bias", outputs)

    def batch_norm(self, name, channels):
        for kind in ("weight", "bias", "running_mean", "running_var"):
            self.numbers(f"{name}.{kind}", channels)
        self.parameters[f"{name}.num_batches_tracked"] = np.array(7, np.int64)

    def blocks(self, names, inputs, channels, bias, dimensions=None):
        """@param names  gives the names of convolution and batch norm of block k"""
        for k, outputs in enumerate(channels):
            convolution, norm = names(k)
            self.convolution(convolution, inputs, outputs, bias, dimensions)
            self.batch_norm(norm, outputs)
            inputs = outputs
        return inputs


def pcdet_names(sequence):
    return lambda k: (f"{sequence}.{3 * k}", f"{sequence}.{3 * k + 1}")


def mm_names(sequence):
    return lambda k: (f"{sequence}{k}.conv", f"{sequence}{k}.bn")


def make_backbone(maker, prefix, block_names, joined_names, bias):
    inputs = 1
    for i, layer in enumerate(SCALE_CHANNELS):
        for s, channels in enumerate(layer):
            maker.blocks(block_names(f"{prefix}SA_modules.{i}.mlps.{s}"), inputs + 3, channels, bias, 4)
        maker.blocks(joined_names(i), sum(channels[-1] for channels in layer), [JOINED[i]], bias, 3)
        inputs = JOINED[i]


def pcdet_vote(classes):
    maker = Maker(3)
    make_backbone(maker, "backbone_3d.", pcdet_names, lambda i: pcdet_names(f"backbone_3d.SA_modules.{i}.aggregation_mlp"),
                  False)
    for s, channels in enumerate(CANDIDATE_CHANNELS):
        maker.blocks(pcdet_names(f"point_head.SA_module.mlps.{s}"), JOINED[-1] + 3, channels, False, 4)
    shared = maker.blocks(pcdet_names("point_head.shared_fc_layer"), 23, [14, 13], False)
    for name, inputs, outputs in (("vote", JOINED[-1], 3), ("cls", shared, classes), ("reg", shared, 6 + 2 * BINS)):
        last = maker.blocks(pcdet_names(f"point_head.{name}_layers"), inputs, [15], False)
        maker.convolution(f"point_head.{name}_layers.3", last, outputs, True)
    maker.parameters["global_step"] = np.array([3], np.int64)
    return maker.parameters


def pcdet_ssd(classes):
    maker = Maker(2)
    make_backbone(maker, "backbone_3d.", pcdet_names, lambda i: pcdet_names(f"backbone_3d.SA_modules.{i}.out_aggregation"),
                  False)
    last = maker.blocks(pcdet_names("backbone_3d.SA_modules.4.mlp_modules"), JOINED[-1], [15], False, 3)
    maker.convolution("backbone_3d.SA_modules.4.ctr_reg", last, 3, True, 3)
    for s, channels in enumerate(CANDIDATE_CHANNELS):
        maker.blocks(pcdet_names(f"backbone_3d.SA_modules.5.mlps.{s}"), JOINED[-1] + 3, channels, False, 4)
    maker.blocks(pcdet_names("backbone_3d.SA_modules.5.out_aggregation"), 23, [16], False, 3)
    for name, outputs in (("cls", classes), ("box", 6 + 2 * BINS)):
        last = maker.blocks(pcdet_names(f"point_head.{name}_center_layers"), 16, [14, 13], False)
        maker.convolution(f"point_head.{name}_center_layers.6", last, outputs, True)
    return maker.parameters


def mmdetection3d(classes):
    maker = Maker(3)
    make_backbone(maker, "backbone.", lambda name: mm_names(f"{name}.layer"),
                  lambda i: lambda _k: (f"backbone.aggregation_mlps.{i}.conv", f"backbone.aggregation_mlps.{i}.bn"), True)
    last = maker.blocks(mm_names("bbox_head.vote_module.vote_conv."), JOINED[-1], [15], True)
    maker.convolution("bbox_head.vote_module.conv_out", last, 3, True)
    for s, channels in enumerate(CANDIDATE_CHANNELS):
        maker.blocks(mm_names(f"bbox_head.vote_aggregation.mlps.{s}.layer"), JOINED[-1] + 3, channels, True, 4)
    shared = maker.blocks(mm_names("bbox_head.conv_pred.shared_convs.layer"), 23, [14, 13], True)
    for name, outputs in (("cls", classes), ("reg", 6 + 2 * BINS)):
        last = maker.blocks(mm_names(f"bbox_head.conv_pred.{name}_convs.layer"), shared, [12], True)
        maker.convolution(f"bbox_head.conv_pred.conv_{name}", last, outputs, True)
    return maker.parameters


def read_safetensors(path):
    data = Path(path).read_bytes()
    length = struct.unpack("<Q", data[:8])[0]
    header = json.loads(data[8:8 + length])
    metadata = header.pop("__metadata__")
    tensors = {}
    for name, entry in header.items():
        begin, end = entry["data_offsets"]
        tensors[name] = np.frombuffer(data[8 + length + begin:8 + length + end], "<f4").reshape(entry["shape"])
    return tensors, metadata


class ConverterTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = os.path.join(self.folder.name, "checkpoint.pth")

    def tearDown(self):
        self.folder.cleanup()

    def save_pcdet(self, parameters):
        torch_file.save(self.path, lambda w: w.value({"epoch": 80, "model_state": w.ordered(parameters), "version": "pcdet"}))

    def save_mm(self, parameters, version):
        meta = {"mmdet3d_version": version, "config": "model = dict()"} if version else {}
        torch_file.save(self.path, lambda w: w.value({"meta": meta, "state_dict": w.ordered(parameters)}))

    def convert(self, **options):
        return converter.convert(*converter.find_parameters(converter.read_checkpoint(self.path)), **options)

    def problem(self, **options):
        with self.assertRaises(converter.ConversionError) as caught:
            self.convert(**options)
        return str(caught.exception)


class Layouts(ConverterTest):
    def check_same(self, tensors, parameters, names):
        """@param names  theirs by ours"""
        for ours, theirs in names.items():
            np.testing.assert_array_equal(tensors[ours], parameters[theirs].reshape(tensors[ours].shape), err_msg=ours)

    def test_pcdet_vote(self):
        parameters = pcdet_vote(1)
        self.save_pcdet(parameters)
        family, tensors, arch = self.convert()
        self.assertEqual(family, "pcdet-vote")
        self.check_same(tensors, parameters, {
            "backbone_3d.SA_modules.1.mlps.2.3.weight": "backbone_3d.SA_modules.1.mlps.2.3.weight",
            "backbone_3d.SA_modules.2.out_aggregation.1.running_var": "backbone_3d.SA_modules.2.aggregation_mlp.1.running_var",
            "point_head.SA_module.mlps.1.0.weight": "point_head.SA_module.mlps.1.0.weight",
            "point_head.vote_layers.3.bias": "point_head.vote_layers.3.bias",
            "point_head.shared_fc_layer.4.bias": "point_head.shared_fc_layer.4.bias"})
        reg = tensors["point_head.reg_layers.3.weight"]
        theirs = parameters["point_head.reg_layers.3.weight"][:, :, 0]
        np.testing.assert_array_equal(reg[:6 + BINS], theirs[:6 + BINS])
        np.testing.assert_allclose(reg[6 + BINS:], 2.0 * theirs[6 + BINS:])
        self.assertEqual(arch["classes"], ["car"])
        self.assertEqual(arch["mean_sizes_lwh_m"], [[1.0, 1.0, 1.0]])
        self.assertEqual([layer["aggregate"] for layer in arch["layers"]], JOINED)
        self.assertEqual([scale["channels"] for scale in arch["layers"][1]["scales"]], SCALE_CHANNELS[1])
        self.assertEqual([scale["inner_radius_m"] for scale in arch["layers"][1]["scales"]], [0.0, 0.4, 0.8])
        self.assertEqual(arch["candidate_layer"]["aggregate"], 0)
        self.assertEqual(arch["head"], {"shared": [14, 13], "classes": [15], "boxes": [15]})
        self.assertEqual(arch["vote"]["channels"], [15])

    def test_pcdet_ssd(self):
        parameters = pcdet_ssd(3)
        self.save_pcdet(parameters)
        family, tensors, arch = self.convert()
        self.assertEqual(family, "pcdet-ssd")
        self.check_same(tensors, parameters, {
            "backbone_3d.SA_modules.0.out_aggregation.0.weight": "backbone_3d.SA_modules.0.out_aggregation.0.weight",
            "point_head.vote_layers.0.weight": "backbone_3d.SA_modules.4.mlp_modules.0.weight",
            "point_head.vote_layers.3.weight": "backbone_3d.SA_modules.4.ctr_reg.weight",
            "point_head.SA_module.mlps.0.4.running_mean": "backbone_3d.SA_modules.5.mlps.0.4.running_mean",
            "point_head.SA_module.out_aggregation.0.weight": "backbone_3d.SA_modules.5.out_aggregation.0.weight",
            "point_head.cls_layers.6.bias": "point_head.cls_center_layers.6.bias",
            "point_head.reg_layers.6.weight": "point_head.box_center_layers.6.weight"})
        self.assertEqual(arch["classes"], ["car", "pedestrian", "cyclist"])
        self.assertEqual(arch["mean_sizes_lwh_m"][1], [0.8, 0.6, 1.73])
        self.assertEqual(arch["head"], {"shared": [], "classes": [14, 13], "boxes": [14, 13]})
        self.assertEqual(arch["candidate_layer"]["aggregate"], 16)
        self.assertAlmostEqual(arch["box_code"]["first_angle_rad"], -math.pi + math.pi / BINS)

    def test_mmdetection3d(self):
        parameters = mmdetection3d(1)
        self.save_mm(parameters, "1.0.0rc4")
        family, tensors, arch = self.convert()
        self.assertEqual(family, "mmdetection3d")
        self.check_same(tensors, parameters, {
            "backbone_3d.SA_modules.1.mlps.2.3.weight": "backbone.SA_modules.1.mlps.2.layer1.conv.weight",
            "backbone_3d.SA_modules.2.out_aggregation.1.running_var": "backbone.aggregation_mlps.2.bn.running_var",
            "point_head.vote_layers.1.weight": "bbox_head.vote_module.vote_conv.0.bn.weight",
            "point_head.vote_layers.3.weight": "bbox_head.vote_module.conv_out.weight",
            "point_head.SA_module.mlps.1.3.weight": "bbox_head.vote_aggregation.mlps.1.layer1.conv.weight",
            "point_head.shared_fc_layer.3.weight": "bbox_head.conv_pred.shared_convs.layer1.conv.weight",
            "point_head.cls_layers.0.weight": "bbox_head.conv_pred.cls_convs.layer0.conv.weight",
            "point_head.cls_layers.3.bias": "bbox_head.conv_pred.conv_cls.bias"})
        # a bias in front of a batch norm goes into its mean
        for ours, theirs in (("backbone_3d.SA_modules.1.mlps.2", "backbone.SA_modules.1.mlps.2.layer0"),
                             ("backbone_3d.SA_modules.2.out_aggregation", "backbone.aggregation_mlps.2")):
            np.testing.assert_allclose(tensors[f"{ours}.1.running_mean"],
                                       parameters[f"{theirs}.bn.running_mean"] - parameters[f"{theirs}.conv.bias"])
            self.assertNotIn(f"{ours}.0.bias", tensors)
        # their epsilon is 1e-3, ours 1e-5: only the sum counts
        theirs = parameters["bbox_head.vote_module.vote_conv.0.bn.running_var"]
        np.testing.assert_allclose(tensors["point_head.vote_layers.1.running_var"] + 1e-5, theirs + 1e-3, rtol=1e-6)
        reg = tensors["point_head.reg_layers.3.bias"]
        theirs = parameters["bbox_head.conv_pred.conv_reg.bias"]
        np.testing.assert_array_equal(reg[:6 + BINS], theirs[:6 + BINS])
        np.testing.assert_allclose(reg[6 + BINS:], 2.0 * theirs[6 + BINS:])
        self.assertEqual(arch["box_code"]["first_angle_rad"], 0.0)

    def test_every_number_is_used_once(self):
        for make in (pcdet_vote, pcdet_ssd, mmdetection3d):
            parameters = make(2)
            _, tensors, _ = converter.convert(parameters, {"mmdet3d_version": "1.1.0"}, classes=["car", "van"])
            theirs = sum(value.size for name, value in parameters.items()
                         if value.dtype == np.float32 and not name.endswith("conv.bias"))
            self.assertEqual(sum(value.size for value in tensors.values()), theirs)


class OldBoxes(ConverterTest):
    """MMDetection3D before 1.0: width, length, height; yaw' = -yaw - pi / 2."""

    @staticmethod
    def decode(values, first_angle_rad, residual_unit_rad):
        bin_of_box = int(np.argmax(values[6:6 + BINS]))
        middle = first_angle_rad + 2.0 * math.pi / BINS * bin_of_box
        return middle + values[6 + BINS + bin_of_box] * residual_unit_rad

    def test_give_the_same_boxes(self):
        parameters = mmdetection3d(1)
        self.save_mm(parameters, None)
        _, tensors, arch = self.convert(coordinates="before-1.0")
        features = np.linspace(-1.0, 1.0, 12, dtype=np.float32)
        weight = parameters["bbox_head.conv_pred.conv_reg.weight"][:, :, 0]
        for seed in range(20):
            shift = np.random.default_rng(seed).normal(size=6 + 2 * BINS).astype(np.float32)
            parameters["bbox_head.conv_pred.conv_reg.bias"] = shift
            self.save_mm(parameters, None)
            _, tensors, arch = self.convert(coordinates="before-1.0")
            old = weight @ features + shift
            new = tensors["point_head.reg_layers.3.weight"] @ features + tensors["point_head.reg_layers.3.bias"]
            np.testing.assert_allclose(new[:6], old[[0, 1, 2, 4, 3, 5]], rtol=1e-5)
            old_yaw = self.decode(old, 0.0, 2.0 * math.pi / BINS)
            new_yaw = self.decode(new, arch["box_code"]["first_angle_rad"], math.pi / BINS)
            difference = new_yaw - (-old_yaw - math.pi / 2.0)
            self.assertAlmostEqual(math.remainder(difference, 2.0 * math.pi), 0.0, places=5)

    def test_ask_where_the_version_does_not_tell(self):
        for version in (None, "0.16.0"):
            self.save_mm(mmdetection3d(1), version)
            self.assertIn("--coordinates", self.problem())
            self.convert(coordinates="since-1.0")


class BrokenCheckpoints(ConverterTest):
    def test_missing_unknown_and_wrong_parameters_are_listed(self):
        parameters = pcdet_vote(1)
        del parameters["backbone_3d.SA_modules.0.mlps.1.0.weight"]
        del parameters["point_head.vote_layers.1.running_var"]
        parameters["point_head.shared_fc_layer.0.weight"] = np.zeros((14, 20, 1), np.float32)
        self.save_pcdet(parameters)
        problem = self.problem()
        self.assertIn("backbone_3d.SA_modules.0.mlps.1.0.weight is missing", problem)
        self.assertIn("point_head.vote_layers.1.running_var is missing", problem)
        self.assertIn("point_head.shared_fc_layer.0.weight is (14, 20), not (14, 23)", problem)
        parameters["backbone_3d.SA_modules.0.confidence_mlp.0.weight"] = np.zeros((1, 8, 1), np.float32)
        self.save_pcdet(parameters)
        self.assertIn("confidence_mlp.0.weight", self.problem())

    def test_any_missing_parameter_is_found(self):
        for make in (pcdet_vote, pcdet_ssd):
            whole = make(1)
            for name in whole:
                if name.endswith("num_batches_tracked") or name == "global_step":
                    continue
                with self.assertRaises(converter.ConversionError, msg=name):
                    converter.convert({key: value for key, value in whole.items() if key != name}, {})

    def test_numbers_that_are_not_finite(self):
        parameters = pcdet_vote(1)
        parameters["point_head.vote_layers.3.bias"][1] = np.nan
        self.save_pcdet(parameters)
        self.assertIn("point_head.vote_layers.3.bias holds numbers that are not finite", self.problem())

    def test_other_networks_and_classes(self):
        self.save_pcdet({"backbone.weight": np.zeros(3, np.float32)})
        self.assertIn("not named like", self.problem())
        self.save_pcdet({})
        self.assertIn("no parameters", self.problem())
        self.save_pcdet(pcdet_vote(4))
        self.assertIn("4 classes", self.problem())
        self.save_pcdet(pcdet_vote(2))
        self.assertIn("2 classes", self.problem(classes=["car"]))

    def test_files_that_are_none(self):
        Path(self.path).write_bytes(pickle.dumps({"model_state": {}}, protocol=2))
        self.assertIn("before 1.6", self.problem())
        self.save_pcdet(pcdet_vote(1))
        whole = Path(self.path).read_bytes()
        for share in (0.1, 0.5, 0.99):
            Path(self.path).write_bytes(whole[:int(share * len(whole))])
            self.assertIn("no zip archive", self.problem())

    def test_tensors_beyond_their_storage(self):
        value = np.arange(6, dtype=np.float32).reshape(2, 3)
        torch_file.save(self.path, lambda w: w.value({"x": w.tensor(value, stride=[4, 1])}))
        self.assertIn("beyond its storage", self.problem())


class Reading(ConverterTest):
    def test_views_types_and_nested_objects(self):
        grid = np.arange(6, dtype=np.float32).reshape(2, 3)
        torch_file.save(self.path, lambda w: w.value({
            "transposed": w.tensor(grid, offset=2, stride=[1, 2]), "half": grid.astype(np.float16),
            "double": grid.astype(np.float64), "number": np.array(4.0, np.float32), "none": np.zeros((0, 3), np.float32)}))
        state = converter.read_checkpoint(self.path)
        np.testing.assert_array_equal(state["transposed"], [[0, 2, 4], [1, 3, 5]])
        np.testing.assert_array_equal(state["half"], grid)
        np.testing.assert_array_equal(state["double"], grid)
        self.assertEqual(state["number"], 4.0)
        self.assertEqual(state["none"].shape, (0, 3))

    def test_nothing_in_the_file_is_executed(self):
        marker = os.path.join(self.folder.name, "executed")
        call = torch_file.global_name("os", "system") + b"(" + torch_file.text(f"touch {marker}") + b"tR"
        evaluate = torch_file.global_name("builtins", "eval") + b"(" + torch_file.text(f"open({marker!r}, 'w')") + b"tR"
        torch_file.save(self.path, lambda w: w.value({"model_state": w.ordered(pcdet_vote(1)), "a": call, "b": evaluate}))
        self.convert()
        self.assertFalse(os.path.exists(marker))


class Program(ConverterTest):
    def run_script(self, *arguments):
        return subprocess.run([sys.executable, SCRIPT, self.path, *arguments], capture_output=True, text=True, check=False)

    def test_writes_the_weights_file(self):
        self.save_pcdet(pcdet_ssd(3))
        out = os.path.join(self.folder.name, "weights.safetensors")
        changes = os.path.join(self.folder.name, "changes.json")
        Path(changes).write_text(json.dumps({"input": {"half_angle_deg": 180}}), encoding="utf-8")
        done = self.run_script(out, "--architecture", changes)
        self.assertEqual(done.returncode, 0, done.stderr)
        tensors, metadata = read_safetensors(out)
        self.assertEqual(metadata["format"], "mlo 3dssd 1")
        arch = json.loads(metadata["architecture"])
        self.assertEqual(arch["input"]["half_angle_deg"], 180)
        self.assertEqual(arch["input"]["sensor_height_m"], 1.73)
        _, expected, _ = self.convert()
        self.assertEqual(tensors.keys(), expected.keys())
        for name, value in expected.items():
            np.testing.assert_array_equal(tensors[name], value)
        once = Path(out).read_bytes()
        self.run_script(out, "--architecture", changes)
        self.assertEqual(Path(out).read_bytes(), once)

    def test_says_what_is_wrong(self):
        out = os.path.join(self.folder.name, "weights.safetensors")
        done = self.run_script(out)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn(self.path, done.stderr)
        self.assertNotIn("Traceback", done.stderr)
        self.assertFalse(os.path.exists(out))


if __name__ == "__main__":
    unittest.main()
