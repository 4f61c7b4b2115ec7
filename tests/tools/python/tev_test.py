#!/usr/bin/env python3
"""Tests of --tev, with a server in place of the viewer: tev_test.py PROGRAM PACKAGE_FOLDER"""
import contextlib
import pathlib
import socket
import struct
import subprocess
import sys
import threading
import unittest

sys.path.insert(0, sys.argv[2])

import numpy

import beampipe
from in_folder import PROGRAM, InFolder

LARGE = (1000, 700)  # more than the buffers of a connection hold


@contextlib.contextmanager
def viewer(serve):
    """HOST:PORT of a server, and a list of what serve() returns. That gets the only connection, and an event that is set
    at the end of the context."""
    results, at_end = [], threading.Event()
    with socket.socket() as listener:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 16)
        listener.bind(("127.0.0.1", 0))
        listener.listen()

        def work():
            connection, _ = listener.accept()
            with connection:
                results.append(serve(connection, at_end))

        thread = threading.Thread(target=work, daemon=True)
        thread.start()
        try:
            yield f"127.0.0.1:{listener.getsockname()[1]}", results
        finally:
            at_end.set()
        thread.join(60)


def read_all(connection, _):
    return b"".join(iter(lambda: connection.recv(1 << 20), b""))


class Packet:
    """Reads what tev's IpcPacket::interpretAs... read."""

    def __init__(self, data):
        self.data, self.at = data, 0

    def numbers(self, form):
        found = struct.unpack_from("<" + form, self.data, self.at)
        self.at += struct.calcsize("<" + form)
        return found

    def text(self):
        end = self.data.index(b"\0", self.at)
        found = self.data[self.at:end].decode()
        self.at = end + 1
        return found


def pictures_in(stream):
    """The pictures that tev would have, by name and in the order in which they come."""
    pictures = {}
    while stream:
        length, = struct.unpack_from("<i", stream)
        assert 5 < length <= len(stream), length
        packet, stream = Packet(stream[4:length]), stream[length:]
        kind, grabs_focus = packet.numbers("BB")
        name = packet.text()
        assert grabs_focus == 0
        if kind == 4:
            width, height, channels = packet.numbers("iii")
            assert [packet.text() for _ in range(channels)] == ["R", "G", "B"]
            assert name not in pictures
            pictures[name] = numpy.full((height, width, channels), numpy.nan, "f4")
        else:
            assert kind == 6, kind
            channels, = packet.numbers("i")
            names = [packet.text() for _ in range(channels)]
            x, y, width, height = packet.numbers("iiii")
            offsets, strides = packet.numbers(f"{channels}q"), packet.numbers(f"{channels}q")
            values = numpy.frombuffer(packet.data, "<f4", offset=packet.at)
            packet.at = len(packet.data)
            last = width * height - 1
            assert len(values) == 1 + max(offset + last * stride for offset, stride in zip(offsets, strides))
            for channel, offset, stride in zip(names, offsets, strides):
                part = values[offset::stride][:width * height].reshape(height, width)
                target = pictures[name][y:y + height, x:x + width, "RGB".index(channel)]
                assert target.shape == part.shape and numpy.isnan(target).all(), "outside, or twice"
                target[:] = part
        assert packet.at == len(packet.data)
    return pictures


class Tev(InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        scene = ["make", "fence", "--triangles", "1000"]
        cls.run_program(*scene, "--width", "33", "--height", "21", "--frames", "2", "--pan", "0.3,0.1", "-o", "small.json")
        cls.run_program(*scene, "--width", str(LARGE[0]), "--height", str(LARGE[1]), "-o", "large.json")
        cls.run_large = ["run", "large.json", "-t", "msaa:1", "msaa:2", "-o"]
        cls.run_program(*cls.run_large, "alone")

    def render(self, *arguments):
        """What the program prints on stderr."""
        return subprocess.run([PROGRAM, *arguments], cwd=self.folder, check=True, capture_output=True, text=True).stderr

    def expect_written(self, pictures, folder, names):
        """Each name is TRACE/SPEC/frame N."""
        self.assertEqual(list(pictures), names)
        report = beampipe.Report(self.folder / folder)
        for name in names:
            _, spec, frame = name.split("/")
            written = report.picture(spec, int(frame.removeprefix("frame ")))[..., :3]
            self.assertEqual(pictures[name].tobytes(), written.astype("f4").tobytes(), name)
            self.assertGreater(numpy.ptp(written), 0, name)

    def test_pictures_of_compare_are_those_of_the_files(self):
        with viewer(read_all) as (address, streams):
            errors = self.render("compare", "small.json", "-t", "beam", "msaa:8", "--tev", address, "-o", "compared")
        self.assertEqual(errors, "")
        self.expect_written(pictures_in(streams[0]), "compared",
                            [f"small/{spec}/frame {n}" for n in range(2) for spec in ("reference", "beam", "msaa:8")])

    def test_large_pictures_come_in_several_packets(self):
        with viewer(read_all) as (address, streams):
            self.render(*self.run_large, "large", "--tev", address)
        self.expect_written(pictures_in(streams[0]), "large", ["large/msaa:1/frame 0", "large/msaa:2/frame 0"])

    def test_results_do_not_say_that_they_were_shown(self):
        command = ["run", "small.json", "-t", "beam", "-o"]
        self.render(*command, "unseen")
        with viewer(read_all) as (address, _):
            self.render(*command, "shown", "--tev", address)
        unseen, shown = (beampipe.Report(self.folder / folder).json["made_by"] for folder in ("unseen", "shown"))
        self.assertEqual(unseen, shown)
        self.assertIn("already finished", self.run_program(*command, "shown", "--resume"))

    def expect_loss(self, serve, reason):
        with viewer(serve) as (address, _):
            errors = self.render(*self.run_large, "lost", "--tev", address)
            self.assertRegex(errors, f"^beampipe: note: tev at {address} shows no more pictures: ({reason})\n$")
        lost, alone = (sorted(pathlib.Path(self.folder / folder).rglob("*.exr")) for folder in ("lost", "alone"))
        self.assertEqual([file.name for file in lost], [file.name for file in alone])
        self.assertEqual([file.read_bytes() for file in lost], [file.read_bytes() for file in alone])

    def test_a_run_goes_on_when_the_viewer_is_closed(self):
        self.expect_loss(lambda connection, _: connection.recv(1000), "Connection reset by peer|Broken pipe")

    def test_a_run_goes_on_when_the_viewer_hangs(self):
        self.expect_loss(lambda _, at_end: at_end.wait(60), "Connection timed out")

    def test_a_viewer_that_is_not_there_is_an_error_before_anything_is_rendered(self):
        with socket.socket() as silent:  # bound, so that nobody else listens there
            silent.bind(("127.0.0.1", 0))
            address = f"127.0.0.1:{silent.getsockname()[1]}"
            for command in ("run", "compare"):
                errors = self.run_program(command, "small.json", "-t", "beam", "--tev", address, "-o", "none", fails=1)
                self.assertEqual(errors, f"beampipe: error: {address}: expected the image viewer tev to listen there: "
                                         "Connection refused\n")
        self.assertFalse((self.folder / "none").exists())

    def test_a_viewer_that_does_not_answer_is_an_error(self):
        with contextlib.ExitStack() as sockets:
            silent = sockets.enter_context(socket.create_server(("127.0.0.1", 0), backlog=0))
            for _ in range(3):  # fill its queue, so that Linux lets later ones wait
                early = sockets.enter_context(socket.socket())
                early.setblocking(False)
                early.connect_ex(silent.getsockname())
            errors = self.run_program("run", "small.json", "-t", "beam", "--tev", f"127.0.0.1:{silent.getsockname()[1]}", "-o",
                                      "none", fails=1)
        self.assertRegex(errors, "expected the image viewer tev to listen there: Connection timed out\n$")
        self.assertFalse((self.folder / "none").exists())

    def test_addresses_are_a_host_and_a_port(self):
        for address in ("localhost", ":14158", "localhost:", "localhost:0", "localhost:65536", "localhost:1x", "a:b:1",
                        "localhost:-1"):
            errors = self.run_program("run", "small.json", "-t", "beam", f"--tev={address}", "-o", "none", fails=2)
            self.assertRegex(errors, f"^beampipe: error: --tev {address}: expected HOST:PORT, such as localhost:14158[^\n]*\n$")
        self.assertFalse((self.folder / "none").exists())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
