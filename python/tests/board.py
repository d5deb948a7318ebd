"""A board for the tests: the instrument and the simulated rig behind a pseudo-terminal, which answer as the board's console does."""

import os
import pty
import threading
import tty
import zlib

import pt326


class SimulatedBoard:
    """Answers at `port`, and streams a tick for every few bytes of time: as fast as it is read."""

    def __init__(self, ticks: int = 4000, armed: bool = True) -> None:
        self.typed = bytearray()
        self.stopped = threading.Event()
        self._ticks, self._armed = ticks, armed
        self._end, other = pty.openpty()
        tty.setraw(other)
        self.port = os.ttyname(other)
        self._other = other
        self._streaming = threading.Event()
        self._writing = threading.Lock()
        threading.Thread(target=self._hear, daemon=True).start()
        threading.Thread(target=self._stream, daemon=True).start()

    def _write(self, text: str) -> None:
        with self._writing:
            data = text.encode()
            while data:
                data = data[os.write(self._end, data) :]

    def _hear(self) -> None:
        line = ""
        while True:
            for byte in os.read(self._end, 64):
                self.typed.append(byte)
                if byte == 0x1B or byte == 0x03:
                    self.stopped.set()
                elif byte == 0x15:
                    line = ""
                    self._write("\r\n> ")
                elif byte == ord("\r"):
                    self._write(f"{line}\r\n{self._answer(line)}> ")
                    line = ""
                else:
                    line += chr(byte)

    def _answer(self, line: str) -> str:
        if line == "get":
            return "setpoint = 36 degC\r\n"
        if line == "stream on":
            self._streaming.set()
            return "ok\r\n"
        if line in ("arm", "status"):
            return "ok\r\n"
        return f"error: unknown command: {line}\r\n"

    def _stream(self) -> None:
        self._streaming.wait()
        rig = pt326.Rig("paper", seed=3, faults=[{"do": "offset", "sensor": "t2", "size": 1.5, "at": 390, "for": 1e6}])
        config = pt326.Config()
        config["setpoint"] = 36.0
        instrument = pt326.Instrument(config)
        if self._armed:
            instrument.arm()
        for _ in range(self._ticks):
            power = instrument.control(rig.codes)
            line = instrument.diagnose().log_line()
            assert line is not None
            self._write(f"\x02{line}*{zlib.crc32(line.encode()):08x}\r\n")
            rig.step(power)
