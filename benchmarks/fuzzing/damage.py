"""Damage to files: what disks, networks, editors, other programs and malice do."""

import io
import random
import re
import struct
import tokenize
import zlib
from collections.abc import Callable

import numpy as np

Damage = Callable[[random.Random, bytes], bytes]

NUMBERS = (0, 1, 0x7F, 0xFF, 0x7FFFFFFF, 0xFFFFFFFF, 1 << 40, (1 << 63) - 1)
CELLS = b"nan inf -inf 1e400 -1e400 1e-400 0x1F 1_000 1,5 true None \xff \x00".split()
CELLS += [b"9" * 5000, b"", b'"', b'"1"', b"'", "−1".encode(), b"=1+1", b" "]
WORDS = b"-0 1e999 nan inf {} [] [[]] true null '' \"\" 1979-05-27 -1 1e-999".split()
WORDS += [b"9" * 400, b"[1, [2, {a = 3}]]", b'"\\u0000"', b"0x7fffffffffffffffffff"]
SNIPPETS = (
    "raise SystemExit('no more')",
    "raise SystemExit(0)",
    "import sys; sys.exit(3)",
    "raise KeyError('\\n'.join('lines'))",
    "raise RecursionError",
    "def f(): return f()\nf()",
    "raise MemoryError",
    "x = 'a' * 10**12",
    "x = [0] * 10**11",
    "raise BaseException('base')",
    "raise GeneratorExit",
    "raise StopIteration",
    "raise UnicodeDecodeError('utf-8', b'x', 0, 1, 'bad')",
    "class E(Exception):\n    def __str__(self): raise ValueError\nraise E",
    "class E(Exception):\n    def __str__(self): return 'x' * 10**6\nraise E",
    "import warnings; warnings.warn('look here')",
    "import nowhere",
    "from bondgraph import Nothing",
    "import os; os.chdir('/')",
    "import sys; sys.stdout = None",
    "print('x' * 10**6)",
    "import bondgraph; bondgraph.BondGraph = None",
    "cart = 3",
    "cart = lambda: 3",
    "def cart(): return None",
    "def cart(x): return x",
    "def cart():\n    raise ExceptionGroup('many', [ValueError(1)])",
    "def cart():\n    import sympy\n    g = BondGraph('g')\n"
    "    g.one('j', R('r', law=sympy.Symbol('f') ** 10**9), I('m'))\n    return g",
    "def cart():\n    g = BondGraph('g')\n    g.one('j', R('r', law='f +'))\n"
    "    return g",
    "def cart():\n    g = BondGraph('g')\n    g.one('j', R('r', law=object()))\n"
    "    return g",
    "def cart():\n    g = BondGraph('g')\n    g.one('j', R('r', law=float('nan')), "
    "I('m'))\n    return g",
    "def cart():\n    g = BondGraph(None)\n    g.one(7, R(None))\n    return g",
    "def cart():\n    g = BondGraph('g')\n    g.one('j', R('r'), I('m'))\n"
    "    g.parameter('r', 'much')\n    return g",
    "def cart():\n    g = BondGraph('g')\n    g.one('j', R('r'), I('m'))\n"
    "    g.parameter('r', float('inf'), 'kg' * 1000)\n    return g",
    "def cart():\n    g = BondGraph('g', domain=[])\n    return g",
    "def cart():\n    g = BondGraph('g')\n    g.include(g)\n    return g",
    "\x00",
    "\t return",
    "(" * 3000,
    "-" * 20000 + "1",
    "x = " + "+".join(["1"] * 20000),
)


def nothing(draw: random.Random, content: bytes) -> bytes:
    """Leave a file as it is."""
    return content


def flipped_bits(draw: random.Random, content: bytes) -> bytes:
    """Turn up to twenty bits over."""
    data = bytearray(content)
    for _ in range(draw.randint(1, 20)):
        data[draw.randrange(len(data))] ^= 1 << draw.randrange(8)
    return bytes(data)


def cut_short(draw: random.Random, content: bytes) -> bytes:
    """Leave the end out."""
    return content[: draw.randrange(len(content))]


def piece_lost(draw: random.Random, content: bytes) -> bytes:
    """Leave a piece in the middle out."""
    first, last = sorted(draw.choices(range(len(content)), k=2))
    return content[:first] + content[last:]


def piece_repeated(draw: random.Random, content: bytes) -> bytes:
    """Write a piece twice."""
    first, last = sorted(draw.choices(range(len(content)), k=2))
    return content[:last] + content[first:]


def noise(draw: random.Random, content: bytes) -> bytes:
    """Write random bytes over a piece, or instead of the whole."""
    size = draw.choice([4, 16, 256, len(content)])
    at = draw.randrange(len(content))
    return content[:at] + draw.randbytes(size) + content[at + size :]


def extreme_number(draw: random.Random, content: bytes) -> bytes:
    """Write an extreme number where a length, offset or count may stand."""
    width, code = draw.choice([(4, "<I"), (8, "<Q"), (4, ">I")])
    at = draw.randrange(max(1, len(content) - width))
    number = draw.choice(NUMBERS) % (1 << (8 * width))
    return content[:at] + struct.pack(code, number) + content[at + width :]


def other_encoding(draw: random.Random, content: bytes) -> bytes:
    """Write the text in another encoding, or with another mark or end of line."""
    text = content.decode("latin-1")
    return draw.choice(
        [
            text.encode("utf-16"),
            text.encode("utf-16-be"),
            text.encode("utf-32"),
            b"\xef\xbb\xbf" + content,
            content.replace(b"\n", b"\r\n"),
            content.replace(b"\n", b"\r"),
            content.replace(b"\n", b"\x0b"),
            text.replace("e", "é").encode("latin-1"),
            content.replace(b",", b";"),
            content.replace(b",", b"\t"),
        ]
    )


def odd_cells(draw: random.Random, content: bytes) -> bytes:
    """Put strange words where numbers were."""
    found = list(re.finditer(rb"-?\d+(\.\d+)?", content)) or [re.match(b"", content)]
    for match in draw.sample(found, min(len(found), draw.randint(1, 3))):
        assert match is not None
        word = draw.choice(CELLS + WORDS)
        content = content[: match.start()] + word + content[match.end() :]
    return content


def deep(draw: random.Random, content: bytes) -> bytes:
    """Nest brackets deeper than any stack."""
    depth = draw.choice([200, 5000, 200_000])
    opening, closing = draw.choice([(b"[", b"]"), (b'{"a":', b"}"), (b"{a=", b"}")])
    nested = opening * depth + b"1" + closing * draw.choice([0, depth])
    return draw.choice([nested, b"x = " + nested, content + b"\nx = " + nested])


def long_line(draw: random.Random, content: bytes) -> bytes:
    """Write one line of megabytes, or a header of very many columns."""
    return draw.choice(
        [
            b"x" * 5_000_000,
            b"," * 2_000_000,
            b"time [s],"
            + b",".join(b"c%d [m]" % i for i in range(50_000))
            + b"\n1,2\n",
            content + b"1" * 5_000_000,
            b'"' + content,
            b"\n" * 1_000_000 + content,
        ]
    )


def odd_tokens(draw: random.Random, content: bytes) -> bytes:
    """Swap, drop, double and replace words of a Python file."""
    words = [x.string for x in tokenize.tokenize(io.BytesIO(content).readline)][1:]
    for _ in range(draw.randint(1, 4)):
        i, j = draw.randrange(len(words)), draw.randrange(len(words))
        change = draw.randrange(4)
        if change == 0:
            words[i], words[j] = words[j], words[i]
        elif change == 1:
            words[i] = ""
        elif change == 2:
            words[i] = words[j]
        else:
            words[i] = draw.choice(["None", "'x'", "-1", "1e400", "lambda: 0", "...()"])
    lines = " ".join(words).replace(" \n ", "\n")
    return re.sub(r"\n +(?=graph|return)", "\n    ", lines).encode()


def snippet(draw: random.Random, content: bytes) -> bytes:
    """Add a piece of Python that somebody's model may well have in it."""
    return content + b"\n" + draw.choice(SNIPPETS).encode() + b"\n"


def bomb(draw: random.Random, content: bytes) -> bytes:
    """Write a small file that unpacks to gigabytes, of the kind of `content`."""
    if content.startswith(b"PAR1"):
        return _parquet_bomb()
    if b"\x89HDF" in content[:1024]:
        return _hdf5_bomb()
    return _mat_bomb(draw)


def _parquet_bomb() -> bytes:
    import pyarrow as pa  # noqa: PLC0415
    import pyarrow.parquet as pq  # noqa: PLC0415

    file = io.BytesIO()
    zeros = pa.array(np.zeros(4_000_000))
    names = ["time [s]", "force [N]", "velocity [m/s]"]
    table = pa.table(dict.fromkeys(names, zeros))
    with pq.ParquetWriter(file, table.schema, compression="zstd") as writer:
        for _ in range(40):
            writer.write_table(table)
    return file.getvalue()


def _hdf5_bomb() -> bytes:
    import h5py  # noqa: PLC0415

    file = io.BytesIO()
    with h5py.File(file, "w") as content:
        for name, unit in (("time", "s"), ("force", "N"), ("velocity", "m/s")):
            # Chunks never written take no room and read as zeros.
            item = content.create_dataset(name, (4_000_000_000,), "f8", chunks=(4096,))
            item.attrs["units"] = unit
    return file.getvalue()


def _mat_bomb(draw: random.Random) -> bytes:
    rows = draw.choice([30_000_000, 200_000_000])
    name = b"t\x00\x00\x00"
    flags = struct.pack("<IIII", 6, 8, 6, 0)
    shape = struct.pack("<IIii", 5, 8, rows, 1)
    label = struct.pack("<HH4s", 1, 1, name)
    size = 8 * rows
    head = flags + shape + label + struct.pack("<II", 9, size)
    packer = zlib.compressobj(9)
    parts = [packer.compress(struct.pack("<II", 14, len(head) + size) + head)]
    block = bytes(1 << 24)
    for _ in range(min(size, 1 << 28) >> 24):
        parts.append(packer.compress(block))
    packed = b"".join([*parts, packer.flush()])
    header = b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM"
    return header + struct.pack("<II", 15, len(packed)) + packed


ANY: tuple[Damage, ...] = (
    nothing,
    flipped_bits,
    cut_short,
    piece_lost,
    piece_repeated,
    noise,
)
BINARY: tuple[Damage, ...] = (*ANY, extreme_number, extreme_number, extreme_number)
TEXT: tuple[Damage, ...] = (*ANY, odd_cells, odd_cells, other_encoding, long_line)
DAMAGES: dict[str, tuple[Damage, ...]] = {
    "model": (*ANY, odd_tokens, odd_tokens, snippet, snippet, other_encoding),
    "checks": (*TEXT, deep),
    "shaping": (*TEXT, deep),
    "json": (*TEXT, deep),
    "csv": TEXT,
    "mat": (*BINARY, bomb),
    "mat73": BINARY,
    "hdf5": (*BINARY, bomb),
    "parquet": (*BINARY, bomb),
}
