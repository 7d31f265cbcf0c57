"""Reading CSV, block by block: one compiled pass over good ones, a slow one for faults.

numpy parses the numbers. Only when it cannot is the text walked line by line, to name
the line and the column of the first cell that is at fault, or to let empty cells
through as gaps. Never more than a block of text is held, however long the file.

Loggers write more than a header before the numbers: comments, behind the last of which
the names may stand, and units in a line of their own. And they write dates (ISO 8601):
such a column is seconds since its first row.
"""

import csv
import io
from collections.abc import Iterator, Sequence
from datetime import datetime
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bondgraph.errors import RecordingError
from bondgraph.recordings.channel import FloatArray
from bondgraph.recordings.files import digest
from bondgraph.recordings.names import join_header, split_header
from bondgraph.recordings.repairs import AbstractTable

MARKS = (
    (b"\xff\xfe\x00\x00", "utf-32"),
    (b"\x00\x00\xfe\xff", "utf-32"),
    (b"\xff\xfe", "utf-16"),
    (b"\xfe\xff", "utf-16"),
)
"""What a file begins with that says how it is encoded."""

COMMENTS = ("#", "%")
"""What lines before the header may begin with."""

LONGEST_CELL_SHOWN = 40

BLOCK = 1 << 24
"""Characters of text held at a time."""


class Block(NamedTuple):
    """Whole lines of the file and the number of the first of them."""

    first_line: int
    text: str


class CsvTable(AbstractTable):
    """A CSV file with a header line, maybe comments before it and units below it.

    Parameters
    ----------
    path
        The file; it is read anew for every question.
    delimiter, decimal
        The characters between cells and before decimals.
    encoding
        How the bytes spell characters.
    """

    def __init__(
        self,
        path: Path,
        *,
        delimiter: str = ",",
        decimal: str = ".",
        encoding: str = "utf-8",
    ) -> None:
        _check_marks(delimiter, decimal)
        self.source = str(path)
        self.sha256 = digest(path)
        self._path = path
        self._delimiter = delimiter
        self._decimal = decimal
        self._encoding = _encoding(path, encoding)
        first, header = self._header_line()
        self._first_line = first + 1
        headers = self._with_units(self._split_headers(header))
        self._begins = self._first_dates(len(headers))
        self.headers = tuple(
            join_header(split_header(name)[0], "s") if i in self._begins else name
            for i, name in enumerate(headers)
        )

    def columns(self, indices: Sequence[int]) -> list[FloatArray]:
        """Return the columns numbered `indices`; nan stands for an empty cell."""
        blocks = list(self.blocks(indices))
        return [np.concatenate(column) for column in zip(*blocks, strict=True)]

    def blocks(self, indices: Sequence[int]) -> Iterator[list[FloatArray]]:
        """Yield the columns numbered `indices` block by block, in order."""
        for block in self._text_blocks():
            yield self._fast(block, indices) or self._slow(block, indices)

    def row(self, i: int) -> str:
        """Return the line of the file that row `i` is from."""
        for block in self._text_blocks():
            lines = _filled(block)
            if i < len(lines):
                return f"line {lines[i][0]}"
            i -= len(lines)
        return "its last line"

    def _header_line(self) -> tuple[int, str]:
        """Return the line that names the columns, and its number.

        That is the first with something in it that is no comment, or the comment before
        it where it is numbers already.
        """
        comment = 0, ""
        for number, line in self._decoded_lines():
            if not line.strip("\n"):
                continue
            if not line.startswith(COMMENTS):
                named = comment[1].count(self._delimiter) == line.count(self._delimiter)
                if comment[0] and named and self._is_all_numbers(line):
                    return comment
                return number, line.rstrip("\n")
            comment = number, line.strip("\n").lstrip("".join(COMMENTS))
        raise RecordingError(
            f"{self.source!r} is empty.",
            (self.source,),
            "Its first line must name the columns, as 'time [s],theta [rad]'.",
        )

    def _is_all_numbers(self, line: str) -> bool:
        cells = (cell.strip() for cell in line.strip().split(self._delimiter))
        return all(_is_number(cell, self._decimal) or _date(cell) for cell in cells)

    def _first_dates(self, columns: int) -> dict[int, datetime]:
        """Return the date in the first row of each column that begins with one."""
        _, line = _filled(next(self._text_blocks()))[0]
        dates = enumerate(_date(cell.strip()) for cell in line.split(self._delimiter))
        return {i: date for i, date in dates if date is not None and i < columns}

    def _with_units(self, names: tuple[str, ...]) -> tuple[str, ...]:
        """Return the names with the units of a line below them, if there is one.

        No cell of it is empty or a number, and no name has a unit already.
        """
        block = next(self._text_blocks())
        number, line = _filled(block)[0]
        units = [cell.strip().strip("()[]") for cell in line.split(self._delimiter)]
        words = not any(_is_number(unit, self._decimal) for unit in units)
        bare = not any(name.endswith("]") for name in names)
        if not (words and bare and all(units) and len(units) == len(names)):
            return names
        self._first_line = number + 1
        self._refuse_no_samples()
        return tuple(f"{n} [{unit}]" for n, unit in zip(names, units, strict=True))

    def _decoded_lines(self) -> Iterator[tuple[int, str]]:
        with self._path.open(encoding=self._encoding) as file:
            try:
                yield from enumerate(file, start=1)
            except UnicodeDecodeError as error:
                raise self._undecodable() from error

    def _text_blocks(self) -> Iterator[Block]:
        """Yield the body in blocks of whole lines that have something in them."""
        with self._path.open(encoding=self._encoding) as file:
            try:
                for _ in range(self._first_line - 1):
                    file.readline()
                number = self._first_line
                while text := file.read(BLOCK):
                    text += file.readline()
                    if text.strip():
                        yield Block(number, text)
                    number += text.count("\n")
            except UnicodeDecodeError as error:
                raise self._undecodable() from error

    def _undecodable(self) -> RecordingError:
        """Return the refusal that names the line of the first byte that is no text."""
        content = self._path.read_bytes()
        try:
            content.decode(self._encoding)
        except UnicodeDecodeError as error:
            line = content.count(b"\n", 0, error.start) + 1
            what = f"the byte {content[error.start]:#04x}"
        else:
            line, what = 1, "a byte"
        # "utf-8-sig" is how Python calls UTF-8 that may begin with a mark.
        name = self._encoding.removesuffix("-sig").upper()
        return RecordingError(
            f"Line {line} of {self.source!r} has {what}, which is not {name} text.",
            (self.source,),
            'Save it as UTF-8, or give its encoding, as encoding="latin-1".',
        )

    def _split_headers(self, header: str) -> tuple[str, ...]:
        nameless = "Its first line must name the columns, as 'time [s],theta [rad]'."
        if not header.strip():
            raise RecordingError(f"{self.source!r} is empty.", (self.source,), nameless)
        try:
            (cells,) = csv.reader([header], delimiter=self._delimiter)
        except csv.Error as error:
            raise RecordingError(
                f"The header of {self.source!r} cannot be read ({error}).",
                (self.source,),
                nameless,
            ) from error
        if len(cells) == 1:
            self._refuse_other_delimiter(header)
        if self._is_all_numbers(header):
            raise RecordingError(
                f"{self.source!r} has numbers where its header should be (line "
                f"{self._first_line - 1}).",
                (self.source,),
                nameless,
            )
        self._refuse_no_samples()
        return tuple(cell.strip() for cell in cells)

    def _refuse_no_samples(self) -> None:
        if next(self._text_blocks(), None) is None:
            raise RecordingError(
                f"{self.source!r} has a header and no samples.",
                (self.source,),
                "Check that the recording was saved completely.",
            )

    def _refuse_other_delimiter(self, header: str) -> None:
        for other in (";", "\t", ","):
            if other in header and other != self._delimiter:
                raise RecordingError(
                    f"The header of {self.source!r} is one column when cut at "
                    f"{self._delimiter!r}.",
                    (self.source,),
                    f"It has {other!r} in it: try delimiter={other!r}.",
                )

    def _fast(self, block: Block, indices: Sequence[int]) -> list[FloatArray] | None:
        """Return the columns of a block of plain numbers, None where it is not one."""
        if not self._is_rectangular(block.text):
            return None
        text = block.text
        if self._decimal != ".":
            text = text.replace(self._decimal, ".")
        try:
            table = np.loadtxt(
                io.StringIO(text),
                delimiter=self._delimiter,
                usecols=list(indices),
                comments=None,
                ndmin=2,
            )
        except ValueError:
            return None  # the slow pass says what is wrong, and where
        return [np.ascontiguousarray(column) for column in table.T]

    def _is_rectangular(self, text: str) -> bool:
        """Return whether every line has as many cells as the header."""
        data = np.frombuffer(text.rstrip("\n").encode() + b"\n", dtype=np.uint8)
        ends = np.flatnonzero(data == ord("\n"))
        cuts = np.flatnonzero(data == ord(self._delimiter))
        counts = np.diff(np.searchsorted(cuts, ends), prepend=0)
        return bool(np.all(counts == len(self.headers) - 1))

    def _slow(self, block: Block, indices: Sequence[int]) -> list[FloatArray]:
        values: list[list[float]] = [[] for _ in indices]
        for number, line in _filled(block):
            cells = line.split(self._delimiter)
            if len(cells) != len(self.headers):
                count = f"{len(cells)} cell{'s' * (len(cells) != 1)}"
                raise RecordingError(
                    f"Line {number} of {self.source!r} has {count} and the header "
                    f"{len(self.headers)}.",
                    (self.source,),
                    "Mend or remove that line.",
                )
            for column, index in zip(values, indices, strict=True):
                column.append(self._number(cells[index].strip(), number, index))
        return [np.array(column, dtype=np.float64) for column in values]

    def _number(self, cell: str, line: int, index: int) -> float:
        if not cell:
            return float("nan")
        if index in self._begins:
            return self._seconds(cell, line, index)
        if _is_number(cell, self._decimal):
            return float(cell.replace(self._decimal, "."))
        comma = self._decimal == "." and _is_number(cell, ",")
        raise RecordingError(
            f"Line {line} of {self.source!r} has {_shown(cell)!r} in column "
            f"{index + 1} ({self.headers[index]!r}), which is not a number.",
            (self.source, self.headers[index]),
            'Give decimal=",".'
            if comma
            else "Mend that cell, or leave the column out with channels=(...).",
        )

    def _seconds(self, cell: str, line: int, index: int) -> float:
        """Return the seconds from the first date of a column to another."""
        begin, date = self._begins[index], _date(cell)
        # One clock: all of them with a time zone, or none.
        if date is None or (date.tzinfo is None) != (begin.tzinfo is None):
            raise RecordingError(
                f"Line {line} of {self.source!r} has {_shown(cell)!r} in column "
                f"{index + 1} ({self.headers[index]!r}), which is no date like the "
                f"first, {begin.isoformat()}.",
                (self.source, self.headers[index]),
                "Mend that cell, or write times as seconds.",
            )
        return (date - begin).total_seconds()


def _date(cell: str) -> datetime | None:
    """Return the date and time that a cell is, None where it is none."""
    if not cell[:4].isdigit() or "-" not in cell:
        return None
    try:
        return datetime.fromisoformat(cell)
    except ValueError:
        return None


def _shown(cell: str) -> str:
    return cell[:LONGEST_CELL_SHOWN] + "…" * (len(cell) > LONGEST_CELL_SHOWN)


def _filled(block: Block) -> list[tuple[int, str]]:
    """Return the lines of a block with something in them, with their numbers."""
    lines = enumerate(block.text.split("\n"), start=block.first_line)
    return [(number, line) for number, line in lines if line.strip()]


def _encoding(path: Path, encoding: str) -> str:
    """Return the name of the encoding that Python is to use."""
    if encoding != "utf-8":
        try:
            "".encode(encoding)
        except (LookupError, ValueError) as error:
            raise RecordingError(
                f"There is no encoding {encoding!r}.",
                (encoding,),
                "Write utf-8, utf-16 or latin-1.",
            ) from error
        return encoding
    with path.open("rb") as file:
        begin = file.read(64)
    found = next((name for mark, name in MARKS if begin.startswith(mark)), None)
    if found is None and begin.count(b"\x00") > len(begin) // 3:
        # Latin letters in two bytes: the zero comes first or second.
        found = "utf-16-be" if begin[:1] == b"\x00" else "utf-16-le"
    if found is not None:
        raise RecordingError(
            f"{str(path)!r} is not UTF-8 text; it looks like {found.upper()}.",
            (str(path),),
            f'Give encoding="{found}", or save it as UTF-8.',
        )
    return "utf-8-sig"


def _check_marks(delimiter: str, decimal: str) -> None:
    if len(delimiter) != 1 or decimal not in (".", ",") or delimiter == decimal:
        raise RecordingError(
            f"delimiter={delimiter!r} with decimal={decimal!r} cannot be read.",
            (delimiter, decimal),
            'Give one character between cells and another, "." or ",", before '
            "decimals.",
        )


def _is_number(cell: str, decimal: str) -> bool:
    # Python reads 1_000 as a number; no instrument writes that.
    if "_" in cell:
        return False
    try:
        float(cell.replace(decimal, "."))
    except ValueError:
        return False
    return True
