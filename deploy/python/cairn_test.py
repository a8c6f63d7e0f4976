"""The package against a simulated log and Cairn's program: python3 -m unittest cairn_test, with `cairn` on the PATH."""

from __future__ import annotations

import io
import json
import os
import shutil
import subprocess
import tracemalloc
import unittest
import warnings
import zlib
from pathlib import Path
from typing import Any
from unittest import mock

import cairn
import folder_case
import h5py
import numpy as np
from cairn.checksum import xxh3_128

try:
    import matplotlib
except ImportError:
    matplotlib = None
try:
    import xxhash
except ImportError:
    xxhash = None


class PackageTest(folder_case.FolderCase):
    """In a folder with a map of the log, too."""

    @classmethod
    def setUpClass(cls) -> None:
        super().setUpClass()
        cls.run_of_map = cairn.run("landmark_map", "log.h5", out="map", options={"iterations": 2, "starts": 1}, workers=1)
        warnings.simplefilter("error")

    def refused(self, pattern: str, call, *arguments, error=cairn.InputError, **named) -> None:
        with self.assertRaisesRegex(error, pattern) as caught:
            call(*arguments, **named)
        self.assertNotIn("\n", str(caught.exception))

    def copy(self, name: str, of: str = "map/landmark_map.h5") -> Path:
        return Path(shutil.copy(of, name))

    # What is in a file.

    def test_arrays_are_what_h5py_reads_with_units_and_shapes(self) -> None:
        seen = []
        for path in ("log.h5", "map/landmark_map.h5"):
            with cairn.read(path) as file, h5py.File(path) as plain:
                names = []
                plain.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
                self.assertEqual(list(file), names)
                for name in names:
                    value, unit = file[name], plain[name].attrs["unit"].decode()
                    self.assertEqual(file.unit(name), unit)
                    self.assertEqual(np.shape(value), file.shape(name), name)
                    same = plain[name][:].astype(str) if plain[name].dtype.kind == "S" else plain[name][:]
                    np.testing.assert_array_equal(np.reshape(value, same.shape), same)
                    seen.append(unit)
        self.assertLess({"m", "rad", "s", "rad/m", "m^2", "1"}, set(seen))

    def test_numbers_and_texts_alone_are_no_arrays(self) -> None:
        with cairn.read("map") as file:
            self.assertEqual((file.kind, file.changed), ("landmark_map", False))
            self.assertEqual(file["map/grid/cell_m"], 1.0)
            self.assertIs(type(file["log_hash"]), str)
            self.assertEqual(file.robots, ["robot 0", "robot 1"])
            self.assertEqual(file.under("map/grid").keys(), {"cell_m", "origin_x_m", "origin_y_m", "probability"})
            self.assertIn("  map/landmark_x_m [", str(file))

    def test_poses_are_the_likeliest_of_a_map_and_the_true_ones_of_a_log(self) -> None:
        with cairn.read("map") as file:
            np.testing.assert_array_equal(file.poses("robot 1").x_m, file["robot/1/poses/mode_x_m"])
            np.testing.assert_array_equal(file.poses(1).time_s, file["robot/1/poses/time_s"])
            self.refused("there is no robot 2 .*robot 0, robot 1", file.poses, 2, error=KeyError)
        with cairn.read("log.h5") as log:
            np.testing.assert_array_equal(log.poses(0).heading_rad, log["truth/robot/0/poses/heading_rad"])
            x = y = heading = 0.0
            for turn, forward in zip(log["robot/0/odometry/turn_rad"], log["robot/0/odometry/forward_m"]):
                heading += turn
                x, y = x + forward * np.cos(heading), y + forward * np.sin(heading)
            last = [column[-1] for column in log.odometry()[1:]]
            np.testing.assert_allclose(last, [x, y, np.angle(np.exp(1j * heading))], atol=1e-9)

    def test_what_was_read_outlives_the_file_and_cannot_be_written_to(self) -> None:
        with cairn.read("map") as file:
            x = file["map/landmark_x_m"]
        self.assertIs(file["map/landmark_x_m"], x)
        self.assertGreater(len(x), 5)
        with self.assertRaises(ValueError):
            x[0] = 0
        self.refused("closed before 'map/landmark_y_m' was read", file.__getitem__, "map/landmark_y_m")
        self.refused("is it 'map/landmark_x_m'", file.__getitem__, "map/landmark_x", error=KeyError)

    def test_files_of_h5py_are_read_too(self) -> None:
        with h5py.File("own.h5", "w") as f:
            f.attrs["cairn_format"], f.attrs["cairn_kind"] = 1, "log"
            f["robots"] = ["rover", "Grüß"]
            f["noise/contact_m"] = 0.3
            f["table"] = [["a", "bc", ""], ["Ø", "", "def"]]
            f["many"] = [str(i) for i in range(3000)]
            f["fixed"] = np.array(["ab".encode(), "Ø".encode()])
            f["robot/0/odometry/time_s"] = np.array([1, 2], ">f8")
        with cairn.read("own.h5") as file:
            self.assertEqual(file.robots, ["rover", "Grüß"])
            self.assertEqual(file["noise/contact_m"], 0.3)
            self.assertEqual(file.unit("noise/contact_m"), "1")
            self.assertEqual(file["table"].tolist(), [["a", "bc", ""], ["Ø", "", "def"]])
            self.assertEqual(file["table"].dtype, np.dtype("U3"))
            self.assertEqual(file["many"].tolist(), [str(i) for i in range(3000)])
            self.assertEqual(file["fixed"].tolist(), ["ab", "Ø"])
            np.testing.assert_array_equal(file["robot/0/odometry/time_s"], [1, 2])

    # What is refused.

    def test_a_flipped_byte_anywhere_is_damage(self) -> None:
        good = Path("map/landmark_map.h5").read_bytes()
        for at in (0, 100, len(good) // 2, len(good) - 25, len(good) - 1):
            bad = bytearray(good)
            bad[at] ^= 1
            Path("bad.h5").write_bytes(bad)
            self.refused(r"bad.h5: damaged: its bytes are not those", cairn.read, "bad.h5")

    def test_a_cut_file_and_what_is_none_of_cairns(self) -> None:
        good = Path("map/landmark_map.h5").read_bytes()
        Path("cut.h5").write_bytes(good[: len(good) // 2])
        self.refused("cut.h5: no HDF5 file, or a damaged one", cairn.read, "cut.h5")
        Path("text.h5").write_text("robots")
        self.refused("text.h5: no HDF5 file", cairn.read, "text.h5")
        with h5py.File("other.h5", "w"):
            pass
        self.refused("other.h5: not a Cairn file: it lacks", cairn.read, "other.h5")
        self.refused("nowhere.h5: there is no such file", cairn.read, "nowhere.h5")
        os.mkfifo("pipe.h5")
        self.refused("pipe.h5: no regular file", cairn.read, "pipe.h5")
        os.remove("pipe.h5")

    def test_a_newer_format(self) -> None:
        with h5py.File("newer.h5", "w") as f:
            f.attrs["cairn_format"], f.attrs["cairn_kind"] = 2, "log"
        self.refused("newer.h5: of format 2, newer than 1", cairn.read, "newer.h5")

    def test_a_result_that_was_changed_unless_it_is_wanted(self) -> None:
        with h5py.File(self.copy("edited.h5"), "r+") as f:
            f["map/landmark_x_m"][0] = 99
        self.refused("edited.h5: another program has changed it", cairn.read, "edited.h5")
        with cairn.read("edited.h5", changed=True) as file:
            self.assertEqual((file.changed, file["map/landmark_x_m"][0]), (True, 99))
        with h5py.File(self.copy("log2.h5", "log.h5"), "r+") as f:  # of people
            f["noise/contact_m"][0] = 2
        self.assertTrue(cairn.read("log2.h5").changed)

    def test_data_that_lie_elsewhere(self) -> None:
        with h5py.File("outside.h5", "w") as f:
            f.attrs["cairn_format"], f.attrs["cairn_kind"] = 1, "log"
            f.create_dataset("a", (2,), "f8", external=[("/etc/passwd", 0, 16)])
        self.refused("outside.h5: the data of 'a' lie in another file", cairn.read, "outside.h5")
        with h5py.File("linked.h5", "w") as f:
            f.attrs["cairn_format"], f.attrs["cairn_kind"] = 1, "log"
            f["a"] = h5py.ExternalLink("log.h5", "robots")
        self.refused("'a' is a link; Cairn reads what stands there itself", cairn.read, "linked.h5")
        with h5py.File("twice.h5", "w") as f:
            f.attrs["cairn_format"], f.attrs["cairn_kind"] = 1, "log"
            f["a"] = 1.0
            f["b"] = f["a"]
        self.refused("'a' has two names in this file", cairn.read, "twice.h5")

    def test_what_the_program_refuses_of_units_and_texts(self) -> None:
        def of(text: str, **attributes: str) -> None:
            with self.hostile("own.h5") as f:
                f["robots"], f["odometry/forward_m"] = [text], [1.0]
                for name, value in attributes.items():
                    f["odometry/forward_m"].attrs[name] = value

        of("ann", unit="m")
        with cairn.read("own.h5") as file:
            self.assertEqual(file.robots, ["ann"])
        of("ann", unit="furlong")
        with cairn.read("own.h5") as file:
            self.assertEqual(file.unit("odometry/forward_m"), "furlong")
        for unit, why in (("cm", "says cm, and its name m, as which it would be read"), ("m\x1b[0m", "unit has control characters")):
            of("ann", unit=unit)
            self.refused(why, cairn.read, "own.h5")
            self.refused(why, cairn.command, "inspect", "own.h5")
        for text, why in (("a\x1b[31m", "has control characters"), ("a\u202eb", "has control characters"), ("x" * 257, "is longer than 256 bytes")):
            of(text)
            with cairn.read("own.h5") as file:
                self.refused(why, file.__getitem__, "robots")
            self.refused(why, cairn.command, "inspect", "own.h5")
        with self.hostile("own.h5") as f:
            f["provenance/job"] = "two\nlines"
        self.assertEqual(cairn.read("own.h5")["provenance/job"], "two\nlines")

    def hostile(self, name: str, kind: str = "log", **attributes) -> h5py.File:
        f = h5py.File(name, "w")
        f.attrs["cairn_format"], f.attrs["cairn_kind"] = 1, kind
        for attribute, value in attributes.items():
            f.attrs[attribute] = value
        return f

    def test_whatever_a_file_holds_is_refused_in_one_way(self) -> None:
        self.hostile("trailer.h5", cairn_trailer=[1, 2]).close()
        self.refused("trailer.h5: not a Cairn file: its root attributes", cairn.read, "trailer.h5")
        with self.hostile("hostile.h5") as f:
            f["robots"] = [1, 2]
            f["robots"].attrs["scalar"] = [1, 1]
            f["robots"].attrs["unit"] = ["m", "s"]
            f["none"] = h5py.Empty("f8")
            f["latin"] = np.array([b"\xff\xfe"])
            f["pair"] = np.zeros(2, [("a", "f8")])
            f["no_number"] = np.zeros(0)
            f["no_number"].attrs["scalar"] = 1
            f.create_dataset("lists", (2,), h5py.vlen_dtype("i4"))
            f.create_dataset("references", (2,), h5py.ref_dtype)
            f.create_dataset("huge", (1 << 34,), "f8", chunks=(1 << 20,), compression="gzip")
            f["long"] = ["x" * (1 << 20)] + [""] * 4096
        with cairn.read("hostile.h5") as file:
            self.assertEqual(len(file), 9)
            for name in file:
                self.refused(f"hostile.h5: damaged: '{name}' cannot be read: ", file.__getitem__, name)
            for call, name in ((file.shape, "robots"), (file.unit, "robots"), (file.shape, "none")):
                self.refused(f"hostile.h5: damaged: '{name}' cannot be read: ", call, name)
            self.refused("hostile.h5: damaged: ", str, file)
            self.refused("hostile.h5: damaged: ", lambda: file.robots)
        with self.hostile("shapes.h5") as f:
            f["robots"], f["robot/0/odometry/time_s"] = ["ann"], [1.0, 2.0]
            f["robot/0/odometry/turn_rad"], f["robot/0/odometry/forward_m"] = [1.0, 2.0], [1.0, 2.0, 3.0]
            f["map/grid/probability"] = 0.5
        with cairn.read("shapes.h5") as file:
            self.refused("shapes.h5: damaged: 'robot/0/odometry'", file.odometry)
            if matplotlib is not None:
                matplotlib.use("agg")
                self.refused("shapes.h5: cannot be drawn", file.plot)

    def test_small_files_of_many_long_texts_are_refused_before_they_take_the_memory(self) -> None:
        with self.hostile("fill.h5") as f:
            f.create_dataset("robots", (150_000_000,), "S1", chunks=(10_000_000,), compression="gzip", fillvalue=b"a")
        with self.hostile("one.h5") as f:
            f.create_dataset("robots", (2000,), h5py.string_dtype())[0] = "x" * 1_000_000
            at = f["robots"].id.get_offset()
        whole = bytearray(Path("one.h5").read_bytes())
        whole[at : at + 16 * 2000] = whole[at : at + 16] * 2000  # all refer to the first
        Path("one.h5").write_bytes(whole)
        for name, why in (("fill.h5", "its shape and its data do not agree"), ("one.h5", "its texts are more than its file")):
            tracemalloc.start()
            with cairn.read(name) as file:
                self.refused(f"{name}: damaged: 'robots' cannot be read: {why}", file.__getitem__, "robots")
            self.assertLess(tracemalloc.get_traced_memory()[1], 200 << 20)
            tracemalloc.stop()

    def test_what_unpacks_to_more_than_it_says_is_refused_before_it_is_unpacked(self) -> None:
        for name, size, times, why in (("once", 1000, 1, "its chunks are more than they unpack to"),
                                       ("large", 1 << 19, 1, "it unpacks to more than its shape says"),
                                       ("twice", 1000, 2, "its filters are none of Cairn's")):
            plan = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
            plan.set_chunk((size,))
            packed = bytes(64 << 20)
            for _ in range(times):
                plan.set_filter(h5py.h5z.FILTER_DEFLATE, 0, (9,))
                packed = zlib.compress(packed, 9)
            with self.hostile(f"{name}.h5") as f:
                space = h5py.h5s.create_simple((size,))
                h5py.h5d.create(f.id, b"x", h5py.h5t.NATIVE_DOUBLE, space, plan).write_direct_chunk((0,), packed)
            with cairn.read(f"{name}.h5") as file:
                self.refused(why, file.__getitem__, "x")
                self.refused("; ask whoever made the file ", file.__getitem__, "x")
        with self.hostile("padding.h5") as f:  # each chunk of the 200 is 32 MiB for one number
            f.create_dataset("x", data=np.ones((200, 1)), maxshape=(200, None), chunks=(1, 1 << 22), compression=1)
        with mock.patch("cairn.files.zlib.decompressobj") as unpack:
            self.refused("it would take 6710886400 bytes", cairn.read("padding.h5").__getitem__, "x")
        unpack.assert_not_called()

    def test_each_chunk_is_unpacked_once_and_none_is_looked_for_in_a_list(self) -> None:
        values = np.arange(70 * 33, dtype="f8").reshape(70, 33)
        with self.hostile("many.h5") as f:
            f.create_dataset("x", data=values, chunks=(4, 5), compression=1, shuffle=True, fletcher32=True)
        with (
            cairn.read("many.h5") as file,
            mock.patch("cairn.files.zlib.decompressobj", wraps=zlib.decompressobj) as unpack,
            mock.patch("cairn.files._listed") as listed,
            mock.patch("h5py.Dataset.__getitem__") as again,
        ):
            self.assertTrue(np.array_equal(file["x"], values))
        self.assertEqual(unpack.call_count, 18 * 7)
        listed.assert_not_called()
        again.assert_not_called()

    def test_packed_arrays_are_what_h5py_reads_whatever_their_type_and_filters(self) -> None:
        number = np.arange(1000) * 7 % 101
        arrays = {kind: number.astype(kind) for kind in ("u1", "i4", "i8", "f4", "f8", ">f8", ">i2", "f2", "bool", "S5", "S12")}
        options: list[dict[str, Any]] = [{}, {"shuffle": True}, {"fletcher32": True}, {"shuffle": True, "fletcher32": True}]
        with self.hostile("kinds.h5") as f:
            for kind, values in arrays.items():
                for i, option in enumerate(options):
                    f.create_dataset(f"{kind}/{i}", data=values, chunks=(999,), compression=4, **option)
            f.create_dataset("texts", data=["ä", "b" * 90, ""] * 40, chunks=(7,), compression=1, shuffle=True)
            f.create_dataset("some", (1000,), "f8", chunks=(10,), compression=1, fillvalue=3)[500:520] = 1
            f.create_dataset("as it is", (4,), "f8", chunks=(4,), compression=1, shuffle=True)
            f["as it is"].id.write_direct_chunk((0,), np.arange(4.0).tobytes(), 3)  # neither filter was used
            f.create_dataset("short", (4,), "f8", chunks=(4,), compression=1).id.write_direct_chunk((0,), zlib.compress(bytes(31)))
            f.create_dataset("cut", (4,), "f8", chunks=(4,), compression=1).id.write_direct_chunk((0,), zlib.compress(bytes(32))[:-1])
        with cairn.read("kinds.h5") as file, h5py.File("kinds.h5") as same:
            for kind, values in arrays.items():
                for i in range(len(options)):
                    read = file[f"{kind}/{i}"]
                    self.assertEqual(read.tolist(), [v.decode() for v in values] if kind[0] == "S" else values.tolist())
                    self.assertTrue(kind[0] == "S" or read.dtype == same[f"{kind}/{i}"].dtype)
            self.assertEqual(file["texts"].tolist(), ["ä", "b" * 90, ""] * 40)
            self.assertEqual((file["some"].sum(), file["as it is"].tolist()), (2960, [0, 1, 2, 3]))
            self.refused("its chunks are not of the size that it says", file.__getitem__, "short")
            self.refused("its data break off", file.__getitem__, "cut")

    def test_what_hdf5_packs_bit_by_bit_is_read_where_it_unpacks_to_what_it_says(self) -> None:
        values = np.arange(1000) * 7 % 101

        def of_12_bits(f: h5py.File, name: str, filters: list[tuple[int, tuple[int, ...]]]) -> h5py.Dataset:
            plan, kind = h5py.h5p.create(h5py.h5p.DATASET_CREATE), h5py.h5t.NATIVE_INT32.copy()
            plan.set_chunk((500,))
            kind.set_precision(12)
            for of, says in filters:
                plan.set_filter(of, 0, says)
            return h5py.Dataset(h5py.h5d.create(f.id, name.encode(), kind, h5py.h5s.create_simple((1000,)), plan))

        n_bit, deflate = (h5py.h5z.FILTER_NBIT, ()), (h5py.h5z.FILTER_DEFLATE, (9,))
        with self.hostile("bits.h5") as f:
            f.create_dataset("scaled", data=values, scaleoffset=0)
            f.create_dataset("scaled and packed", data=values, scaleoffset=0, compression=4, shuffle=True, chunks=(333,))
            f.create_dataset("some digits", data=values / 8, scaleoffset=3)
            of_12_bits(f, "bits", [n_bit])[...] = values
            of_12_bits(f, "bits, packed", [n_bit, deflate])[...] = values
            of_12_bits(f, "packed, bits", [deflate, n_bit])
            f.create_dataset("short", (8,), "i4", chunks=(8,), scaleoffset=0).id.write_direct_chunk((0,), b"\x20" + bytes(40))
            f.create_dataset("wide", (8,), "i4", chunks=(8,), scaleoffset=0).id.write_direct_chunk((0,), b"\x21" + bytes(99))
            of_12_bits(f, "few bits", [n_bit]).id.write_direct_chunk((0,), bytes(749))
        with cairn.read("bits.h5") as file:
            for name in ("scaled", "scaled and packed", "bits", "bits, packed"):
                self.assertEqual(file[name].tolist(), values.tolist(), name)
            np.testing.assert_allclose(file["some digits"], values / 8, atol=1e-3)
            for name in ("short", "wide", "few bits"):
                self.refused("its chunks are not of the size that it says", file.__getitem__, name)
            self.refused("its shape and its data do not agree|its filters are none of Cairn's", file.__getitem__, "packed, bits")

    def test_a_flipped_byte_of_a_chunk_is_seen_by_its_own_checksum(self) -> None:
        for size in (1, 2, 7, 1000, 70_000, 400_000):
            with self.hostile(f"{size}.h5") as f:
                noise = np.random.default_rng(size).integers(0, 256, size, np.uint8)
                f.create_dataset("x", data=noise, chunks=(size,), compression=1, fletcher32=True)
                at, packed = f["x"].id.get_chunk_info(0).byte_offset, f["x"].id.get_storage_size()
            with cairn.read(f"{size}.h5") as file:
                self.assertEqual(file["x"].tolist(), noise.tolist())
            whole = bytearray(Path(f"{size}.h5").read_bytes())
            whole[at + packed // 2] ^= 0x10
            Path("flipped.h5").write_bytes(whole)
            with cairn.read("flipped.h5") as file:
                self.refused("its checksum is wrong", file.__getitem__, "x")

    def test_rows_and_groups_without_end_are_refused(self) -> None:
        with self.hostile("rows.h5") as f:
            f.create_dataset("x", (1 << 40, 0), h5py.string_dtype())
        self.refused("more rows than Cairn's do", cairn.read("rows.h5").__getitem__, "x")
        with self.hostile("deep.h5") as f:
            f["/".join("a" * 40)] = 1.0
        self.refused("groups within groups, more than 32 deep", cairn.read, "deep.h5")
        with self.hostile("names.h5") as f:
            group = f.create_group("a")
            for _ in range(25):  # 2^25 ways
                group["b"] = group["a"] = f.create_group(None)
                group = group["a"]
            group["x"] = 1.0
        self.refused("has two names in this file", cairn.read, "names.h5")

    def test_a_zero_byte_in_a_word_is_refused(self) -> None:
        self.refused("no zero byte", cairn.command, "inspect", "a\0b")

    def test_empty_texts_are_refused_before_a_program_begins(self) -> None:
        with mock.patch("subprocess.Popen", side_effect=AssertionError("a program has begun")):
            self.refused("out: nothing is given", cairn.run, "landmark_map", "log.h5", out="")
            self.refused("out: is not UTF-8", cairn.run, "landmark_map", "log.h5", out=os.fsdecode(b"caf\xe9"))
            self.refused("connect: nothing is given", cairn.submit, "landmark_map", "log.h5", connect="")
            self.refused("server_key: nothing is given", cairn.submit, "landmark_map", "log.h5", server_key="")
            self.refused("each: nothing is given", cairn.submit_each, "landmark_map", "")
            self.refused("truth: nothing is given", cairn.evaluate, "map", truth="")
            self.refused("is empty", cairn.evaluate, "", truth="log.h5")
            self.refused("is empty", cairn.run, "landmark_map", "")
            self.refused("is empty", cairn.command, "inspect", "")

    def test_what_a_stranger_wrote_is_printed_escaped(self) -> None:
        self.hostile("escapes.h5", "log\x1b[31m").close()
        self.refused("its root attribute cairn_kind has control characters", cairn.read, "escapes.h5")
        with self.hostile("escapes.h5") as f:
            f["a\x1b[2J"] = 1.0
        self.refused(r"the name of the dataset 'a\\x1b\[2J' has control characters", cairn.read, "escapes.h5")

    def test_a_folder_of_several_results(self) -> None:
        os.makedirs("two", exist_ok=True)
        self.copy("two/a.h5"), self.copy("two/b.h5")
        self.refused("which file of 'two'. It has a.h5, b.h5", cairn.read, "two")

    @unittest.skipIf(xxhash is None, "python3-xxhash is missing")
    def test_the_checksum_is_xxhashs(self) -> None:
        random = np.random.default_rng(1)
        for size in (241, 256, 1023, 1024, 1025, 1088, 1089, 4096 * 1024, 4096 * 1024 + 1, 4097 * 1024 + 65):
            data = random.bytes(size)
            self.assertEqual(xxh3_128(io.BytesIO(data), size), xxhash.xxh3_128(data).digest(), size)

    # The program.

    def test_a_run_has_a_summary_results_and_a_page(self) -> None:
        self.assertEqual(self.run_of_map.results, {"landmark_map": Path("map/landmark_map.h5")})
        self.assertTrue(self.run_of_map.report.is_file())
        self.assertEqual(self.run_of_map.summary["stages"][0]["kind"], "landmark_map")
        with self.run_of_map.read() as file:
            self.assertIn("iterations: 2", file["provenance/job_yaml"])
        self.refused("no stage 'grid', only landmark_map", self.run_of_map.read, "grid", error=KeyError)
        again = cairn.run("landmark_map", "log.h5", out="map", options={"iterations": 2, "starts": 1}, workers=1)
        self.assertEqual(again.summary["note"], "finished already; nothing was run")

    def test_evaluate_says_what_the_program_says(self) -> None:
        said = subprocess.run(["cairn", "evaluate", "map", "--truth", "log.h5", "--json"], check=True, capture_output=True)
        scores = cairn.evaluate("map", truth=Path("log.h5"))
        self.assertEqual(scores, json.loads(said.stdout))
        self.assertGreater(scores["landmarks"]["found"], 0)
        with h5py.File(self.copy("moved.h5"), "r+") as f:
            f["map/landmark_x_m"][:] += 100
        self.refused("another program has changed it", cairn.evaluate, "moved.h5", "log.h5")
        with self.assertWarnsRegex(UserWarning, "has changed moved.h5"):
            self.assertNotEqual(cairn.evaluate("moved.h5", "log.h5", changed=True)["landmarks"], scores["landmarks"])

    def test_errors_are_the_programs_words(self) -> None:
        self.refused("^there is no pipeline 'landmark_mapp'; did you mean", cairn.run, "landmark_mapp", "log.h5")
        self.refused("^--set starts=many: ", cairn.run, "landmark_map", "log.h5", options={"starts": "many"})
        with self.assertRaises(cairn.CairnError) as caught:
            cairn.submit("landmark_map", "log.h5", connect=f"ipc://{os.getcwd()}/none.ipc")
        self.assertNotIsInstance(caught.exception, cairn.InputError)
        self.assertEqual(caught.exception.exit_code, 1)
        with mock.patch.dict(os.environ, PATH="/nowhere"):
            self.refused("there is no program 'cairn' on the path", cairn.evaluate, "map", "log.h5", error=cairn.CairnError)

    def test_options_may_be_of_numpy_and_none_is_not_said(self) -> None:
        plain = cairn.run("landmark_map", "log.h5", out="plain", options={"iterations": 1, "starts": 1, "refine": False})
        numpy = {"iterations": np.int64(1), "starts": np.array(1), "refine": np.bool_(False), "cell_m": None}
        same = cairn.run("landmark_map", "log.h5", out="numpy", options=numpy)
        with h5py.File(plain.results["landmark_map"]) as one, h5py.File(same.results["landmark_map"]) as other:
            self.assertEqual(one["map/landmark_x_m"][:].tolist(), other["map/landmark_x_m"][:].tolist())
        self.refused("^--set starts=1,2: ", cairn.run, "landmark_map", "log.h5", options={"starts": np.array([1, 2])})

    def test_paths_are_no_options(self) -> None:
        self.copy("-x.h5", "log.h5"), self.copy("--help", "map/landmark_map.h5")
        done = cairn.run("landmark_map", "-x.h5", out="-out", options={"iterations": 1, "starts": 1}, workers=1)
        self.assertEqual(done.results["landmark_map"], Path("-out/landmark_map.h5"))
        self.assertEqual(cairn.evaluate("--help", truth="-x.h5"), cairn.evaluate("map", truth="log.h5"))
        for words in ((Path("-x.h5"),), ("--", "-x.h5")):
            self.assertEqual(cairn.command("inspect", *words)["kind"], "log")
        self.refused("--json --die-with-parent: what it says is no JSON", cairn.command, "evaluate", "--help", error=cairn.CairnError)
        self.refused("there is no pipeline '-v'", cairn.run, "-v", "log.h5")

    def test_a_job_is_handed_in(self) -> None:
        with subprocess.Popen(["cairn", "coordinator", "--store", "store"], stderr=subprocess.DEVNULL) as coordinator:
            try:
                for _ in range(600):
                    if subprocess.run(["cairn", "list"], capture_output=True, check=False).returncode == 0:
                        break
                    subprocess.run(["sleep", "0.05"], check=True)
                job = cairn.submit("landmark_map", "log.h5", options={"iterations": 2}, seed=3, priority=2)
                self.assertEqual((job["state"], job["priority"]), ("queued", 2))
                self.assertEqual(cairn.command("status", job["id"])["id"], job["id"])
                cairn.command("list")
                for name in ("monday", "tuesday"):
                    shutil.copy("log.h5", f"fleet-{name}.h5")
                jobs = cairn.submit_each("landmark_map", "fleet-*.h5", options={"iterations": 2}, priority=-1)
                self.assertEqual([(job["name"], job["priority"]) for job in jobs],
                                 [("landmark_map-fleet-monday", -1), ("landmark_map-fleet-tuesday", -1)])
                self.refused("no file matches", cairn.submit_each, "landmark_map", "none-*.h5")
            finally:
                coordinator.terminate()

    # Pictures.

    @unittest.skipIf(matplotlib is None, "python3-matplotlib is missing")
    def test_a_plot_shows_grid_landmarks_and_paths(self) -> None:
        matplotlib.use("agg")
        with cairn.read("map") as file:
            ax = file.plot()
            self.assertEqual(len(ax.images), 1)
            self.assertEqual(len(ax.patches), len(file["map/landmark_x_m"]))
            self.assertEqual([line.get_label() for line in ax.lines if line.get_linestyle() == "-"], file.robots)
            np.testing.assert_array_equal(ax.lines[-1].get_xdata(), file.poses(1).x_m)
            rows, columns = ax.images[0].get_array().shape
            west, east, south, north = ax.images[0].get_extent()
            self.assertEqual((east - west, north - south), (columns, rows))
            self.assertIs(cairn.read("log.h5").plot(ax), ax)
        # A region of 95% of a landmark that is 2 m unsure along the diagonal.
        from cairn.picture import _region

        region = _region(1, 2, 2 * np.array([[1.01, 0.99], [0.99, 1.01]]))
        self.assertAlmostEqual(max(region.width, region.height), 2 * 2 * 2.4477, 3)
        self.assertAlmostEqual((region.angle + (90 if region.height > region.width else 0)) % 180, 45)
        # Names are shown as they are.
        copy = self.copy(r"run $1 of \foo{$.h5")
        with h5py.File(copy, "r+") as f:
            del f["robots"]
            f["robots"] = [r"$\foo{$", "_b"]
        ax = cairn.read(copy, changed=True).plot()
        ax.figure.savefig(io.BytesIO())
        shown = [text.get_text() for text in (*ax.get_legend().get_texts(), ax.title)]
        self.assertEqual([text.replace(r"\$", "$").strip() for text in shown], [r"$\foo{$", "_b", copy.name])
        with h5py.File("bare.h5", "w") as f:
            f.attrs["cairn_format"], f.attrs["cairn_kind"] = 1, "samples"
        self.refused("there is neither a map nor a path", cairn.read("bare.h5").plot)


if __name__ == "__main__":
    unittest.main()
