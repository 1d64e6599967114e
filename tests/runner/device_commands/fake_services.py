"""What stands behind the bridges in devices/external/examples, on this machine: a microcontroller on a pseudo-terminal, an
Inverse Service on loopback. Each presses 4 mm deep once a second, as a hand would, and pushes back as it is told."""
import base64
import hashlib
import json
import math
import os
import socket
import struct
import threading
import time
import tty


def depth_now():
    """m: from -4 to 4 mm, once a second."""
    return 0.004 * math.sin(2 * math.pi * time.monotonic())


class FakeFirmware:
    """The three lines of serial_rig.py."""

    def __init__(self):
        self.master, slave = os.openpty()
        tty.setraw(slave)
        self.path, self.stiffness, self.commands, self.mute = os.ttyname(slave), 0.0, [], False
        threading.Thread(target=self.hear, daemon=True).start()
        threading.Thread(target=self.tell, daemon=True).start()

    def hear(self):
        text = b""
        while True:
            *lines, text = (text + os.read(self.master, 1024)).split(b"\n")
            for line in lines:
                words = line.split()
                self.commands.append(line)
                self.stiffness = float(words[1]) if words[:1] == [b"r"] else 0.0

    def tell(self):
        while True:
            if not self.mute:
                depth = max(0.0, depth_now())
                line = f"d {int(self.stiffness > 0)} {depth:.6f} {self.stiffness * depth:.6f}\n"
                os.write(self.master, line.encode())
            time.sleep(0.004)  # the device's pace


class FakeInverse:
    """The simulation channel of the Inverse Service: its first message by itself, then one answer a message."""

    def __init__(self, surface=0.1):
        self.surface, self.forces, self.first, self.answers = surface, [], None, threading.Event()
        self.answers.set()
        self.listening = socket.create_server(("127.0.0.1", 0))
        self.port = self.listening.getsockname()[1]
        threading.Thread(target=self.serve, daemon=True).start()

    def serve(self):
        while True:
            threading.Thread(target=self.speak, args=(self.listening.accept()[0],), daemon=True).start()

    def speak(self, connection):
        stream = connection.makefile("rwb")
        headers = {}
        while line := stream.readline().strip():
            name, _, value = line.partition(b":")
            headers[name.lower()] = value.strip()
        accept = base64.b64encode(hashlib.sha1(headers[b"sec-websocket-key"] + b"258EAFA5-E914-47DA-95CA-C5AB0DC85B11")
                                  .digest())
        stream.write(b"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                     b"Sec-WebSocket-Accept: " + accept + b"\r\n\r\n")
        self.send(stream, self.state(0.0))
        stream.write(b"\x89\x04ping")  # what a service may say at any time
        stream.flush()
        try:
            while True:
                message = self.receive(stream)
                if message is None:
                    continue
                self.first = self.first or message
                force = message["inverse3"][0]["commands"]["set_cursor_force"]["vector"]["z"]
                self.forces.append(force)
                self.answers.wait()
                self.send(stream, self.state(force))
        except (OSError, ValueError, struct.error, IndexError):
            pass  # the bridge is gone

    def state(self, force):
        vector = lambda z: {"x": 0.0, "y": -0.12, "z": z}
        return {"inverse3": [{"device_id": "049D", "state": {
            "cursor_position": vector(self.surface - depth_now()), "cursor_velocity": vector(0.0),
            "current_cursor_force": {"x": 0.0, "y": 0.0, "z": force}}}]}

    @staticmethod
    def send(stream, message):
        data = json.dumps(message).encode()
        size = bytes([len(data)]) if len(data) < 126 else b"\x7e" + struct.pack(">H", len(data))
        half = len(data) // 2  # in two frames now and then, as RFC 6455 allows
        if len(data) < 240:
            stream.write(b"\x81" + size + data)
        else:
            for opcode, part in ((b"\x01", data[:half]), (b"\x80", data[half:])):
                stream.write(opcode + b"\x7e" + struct.pack(">H", len(part)) + part)
        stream.flush()

    @staticmethod
    def receive(stream):
        head = stream.read(2)
        size = head[1] & 0x7F
        if size == 126:
            size = struct.unpack(">H", stream.read(2))[0]
        mask = stream.read(4)
        data = bytes(byte ^ mask[i % 4] for i, byte in enumerate(stream.read(size)))
        return json.loads(data) if head[0] & 0x0F == 1 else None


class FakeWeart:
    """The WEART middleware: it hears messages that end with "~", and says where the hand is."""

    def __init__(self):
        self.messages = []
        self.listening = socket.create_server(("127.0.0.1", 0))
        self.port = self.listening.getsockname()[1]
        threading.Thread(target=self.serve, daemon=True).start()

    def serve(self):
        while True:
            threading.Thread(target=self.speak, args=(self.listening.accept()[0],), daemon=True).start()

    def speak(self, connection):
        text = b""
        try:
            while data := connection.recv(4096):
                *messages, text = (text + data).split(b"~")
                self.messages += [message.decode() for message in messages]
                connection.sendall(b"Tracking:0:12:0:0:0:0:0:0~")
        except OSError:
            pass  # the bridge is gone
