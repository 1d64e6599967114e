#!/usr/bin/env python3
"""A Haply Inverse3 as a rig: a horizontal surface with a stiffness, through the Inverse Service (WebSocket, JSON, port
10001; version 3.5 of its simulation channel, docs.haply.co/inverseSDK/service). The service answers each message with one
state, so the loop is as fast as it answers, about 1 kHz; where messages stop coming the service lets go by itself.

    {"external": {"command": ["python3", "haply_rig.py", "--surface", "0.1"]}}"""
import argparse
import base64
import json
import os
import socket
import struct
import threading
import time

from plain_rig import Device, serve

MOST_FORCE_N = 8.0  # of the cap that this bridge keeps; the device has its own
SILENCE_S = 0.1


class WebSocket:
    """A client of RFC 6455: text frames, and an answer to ping. Nothing else is needed here."""

    def __init__(self, host, port):
        self.socket = socket.create_connection((host, port), timeout=5)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall((f"GET / HTTP/1.1\r\nHost: {host}:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                             f"Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n").encode())
        self.stream = self.socket.makefile("rb")
        if b" 101 " not in self.stream.readline():
            raise SystemExit("what listens there is no WebSocket")
        while self.stream.readline().strip():
            pass

    def send(self, data, opcode=1):
        mask = os.urandom(4)
        size = bytes([0x80 | len(data)]) if len(data) < 126 else bytes([0xFE]) + struct.pack(">H", len(data))
        self.socket.sendall(bytes([0x80 | opcode]) + size + mask + bytes(b ^ mask[i % 4] for i, b in enumerate(data)))

    def receive(self):
        """The next text, whole."""
        text = b""
        while True:
            head = self.exactly(2)
            size = head[1] & 0x7F
            if size > 125:
                size = struct.unpack(">H" if size == 126 else ">Q", self.exactly(2 if size == 126 else 8))[0]
            data, opcode = self.exactly(size), head[0] & 0x0F
            if opcode == 8:
                raise ConnectionError("the Inverse Service has closed the connection")
            if opcode == 9:
                self.send(data, opcode=10)
            elif opcode in (0, 1):
                text += data
                if head[0] & 0x80:
                    return text

    def exactly(self, count):
        data = self.stream.read(count)
        if len(data) < count:
            raise ConnectionError("the Inverse Service is gone")
        return data


class HaplyDevice(Device):
    def __init__(self, options):
        self.service = WebSocket(options.host, options.port)
        devices = json.loads(self.service.receive()).get("inverse3", [])  # its first message: everything connected
        if not devices:
            raise SystemExit("no Inverse3 is connected")
        self.serial, self.surface = devices[0]["device_id"], options.surface
        self.stiffness, self.newest, self.heard, self.trouble = 0.0, (0.0, 0.0), time.monotonic(), None
        threading.Thread(target=self.loop, daemon=True).start()

    def loop(self):
        message, force = {"session": {"configure": {"profile": {"name": "jnd"}}}}, 0.0
        try:
            while True:
                message["inverse3"] = [{"device_id": self.serial, "commands": {
                    "set_cursor_force": {"vector": {"x": 0.0, "y": 0.0, "z": force}}}}]
                self.service.send(json.dumps(message).encode())
                message = {}
                state = json.loads(self.service.receive())["inverse3"][0]["state"]
                depth = max(0.0, self.surface - state["cursor_position"]["z"])
                force = min(self.stiffness * depth, MOST_FORCE_N)  # z points up: the surface pushes the hand up
                # What the device says that it gives, not what is asked of it.
                self.newest, self.heard = (depth, max(0.0, state["current_cursor_force"]["z"])), time.monotonic()
        except (OSError, KeyError, IndexError, ValueError) as error:
            self.trouble = str(error)

    def begin(self, request):
        self.stiffness = request["value"]

    def step(self, elapsed_s):
        if self.trouble or time.monotonic() - self.heard > SILENCE_S:
            self.off()
            raise SystemExit(self.trouble or "the Inverse Service has fallen silent")
        depth, force = self.newest
        return depth > 0, {"depth": depth, "force": force}

    def delivered(self, peaks):
        return peaks["force"] / peaks["depth"]

    def off(self):
        self.stiffness = 0.0  # the next message of the loop, a millisecond from now, takes the force away


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--host", default="127.0.0.1")
    parser.add_argument("--port", type=int, default=10001)
    parser.add_argument("--surface", type=float, default=0.1, help="height of the surface, m")
    parser.add_argument("--max", type=float, default=1000, help="stiffest surface that is stable on yours, N/m")
    parser.add_argument("--model", action="store_true", help="the service simulates its device")
    options = parser.parse_args()
    device = HaplyDevice(options)
    serve({"protocol": 1, "name": "Haply Inverse3", "version": "1.0", "serial": device.serial, "model": options.model,
           "answers": False, "quantities": [{"name": "stiffness", "unit": "N/m", "min": 50, "max": options.max}],
           "parameters": [], "measures": [{"name": "force", "unit": "N"}, {"name": "depth", "unit": "m"}]}, device)


if __name__ == "__main__":
    main()
