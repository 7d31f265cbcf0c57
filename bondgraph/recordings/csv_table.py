"""Reading CSV: one compiled pass over good files, a slow one that finds the fault.

numpy parses the numbers. Only when it cannot is the text walked line by line, to name
the line and the column of the first cell that is at fault, or to let empty cells
through as gaps.
"""

import csv
import io
from collections.abc import Sequence
from hashlib import sha256

import numpy as np

from bondgraph.errors import RecordingError
from bondgraph.recordings.channel import FloatArray
from bondgraph.recordings.repairs import AbstractTable

UTF16_MARKS = (b"\xff\xfe", b"\xfe\xff")
LONGEST_CELL_SHOWN = 40


class CsvTable(AbstractTable):
    """The content of a CSV file with one header line.

    Parameters
    ----------
    content
        The bytes of the file.
    source
        Its path, for messages.
    delimiter, decimal
        The characters between cells and before decimals.
    encoding
        How the bytes spell characters.
    """

    def __init__(
        self,
        content: bytes,
        source: str,
        *,
        delimiter: str = ",",
        decimal: str = ".",
        encoding: str = "utf-8",
    ) -> None:
        self.source = source
        self.sha256 = sha256(content).hexdigest()
        self._delimiter = delimiter
        self._decimal = decimal
        _check_marks(delimiter, decimal)
        text = _decoded(content, source, encoding)
        text = text.replace("\r\n", "\n").replace("\r", "\n")
        blank = len(text) - len(text.lstrip("\n"))
        header, _, self._body = text[blank:].partition("\n")
        self._first_line = blank + 2
        self.headers = self._split_headers(header)

    def _split_headers(self, header: str) -> tuple[str, ...]:
        if not header.strip():
            raise RecordingError(
                f"{self.source!r} is empty.",
                (self.source,),
                "Its first line must name the columns, as 'time [s],theta [rad]'.",
            )
        try:
            (cells,) = csv.reader([header], delimiter=self._delimiter)
        except csv.Error as error:
            raise RecordingError(
                f"The header of {self.source!r} cannot be read ({error}).",
                (self.source,),
                "Its first line must name the columns, as 'time [s],theta [rad]'.",
            ) from error
        if len(cells) == 1:
            for other in (";", "\t", ","):
                if other in header and other != self._delimiter:
                    raise RecordingError(
                        f"The header of {self.source!r} is one column when cut at "
                        f"{self._delimiter!r}.",
                        (self.source,),
                        f"It has {other!r} in it: try delimiter={other!r}.",
                    )
        if all(_is_number(cell.strip(), self._decimal) for cell in cells):
            raise RecordingError(
                f"{self.source!r} has numbers where its header should be (line "
                f"{self._first_line - 1}).",
                (self.source,),
                "Its first line must name the columns, as 'time [s],theta [rad]'.",
            )
        if not self._body.strip():
            raise RecordingError(
                f"{self.source!r} has a header and no samples.",
                (self.source,),
                "Check that the recording was saved completely.",
            )
        return tuple(cell.strip() for cell in cells)

    def columns(self, indices: Sequence[int]) -> list[FloatArray]:
        """Return the columns numbered `indices`; nan stands for an empty cell."""
        body = self._body
        if self._decimal != ".":
            body = body.replace(self._decimal, ".")
        if self._is_rectangular():
            try:
                table = np.loadtxt(
                    io.StringIO(body),
                    delimiter=self._delimiter,
                    usecols=list(indices),
                    comments=None,
                    ndmin=2,
                )
            except ValueError:
                pass  # the slow pass says what is wrong, and where
            else:
                return [np.ascontiguousarray(column) for column in table.T]
        return self._slow_columns(indices)

    def _is_rectangular(self) -> bool:
        """Return whether every line has as many cells as the header."""
        data = np.frombuffer(self._body.rstrip("\n").encode() + b"\n", dtype=np.uint8)
        ends = np.flatnonzero(data == ord("\n"))
        cuts = np.flatnonzero(data == ord(self._delimiter))
        counts = np.diff(np.searchsorted(cuts, ends), prepend=0)
        return bool(np.all(counts == len(self.headers) - 1))

    def _slow_columns(self, indices: Sequence[int]) -> list[FloatArray]:
        values: list[list[float]] = [[] for _ in indices]
        for number, line in self._lines():
            cells = line.split(self._delimiter)
            if len(cells) != len(self.headers):
                raise RecordingError(
                    f"Line {number} of {self.source!r} has {len(cells)} cells and the "
                    f"header {len(self.headers)}.",
                    (self.source,),
                    "Mend or remove that line.",
                )
            for column, index in zip(values, indices, strict=True):
                column.append(self._number(cells[index].strip(), number, index))
        return [np.array(column, dtype=np.float64) for column in values]

    def _number(self, cell: str, line: int, index: int) -> float:
        if not cell:
            return float("nan")
        if _is_number(cell, self._decimal):
            return float(cell.replace(self._decimal, "."))
        shown = cell[:LONGEST_CELL_SHOWN] + "…" * (len(cell) > LONGEST_CELL_SHOWN)
        comma = self._decimal == "." and _is_number(cell, ",")
        raise RecordingError(
            f"Line {line} of {self.source!r} has {shown!r} in column {index + 1} "
            f"({self.headers[index]!r}), which is not a number.",
            (self.source, self.headers[index]),
            'Give decimal=",".'
            if comma
            else "Mend that cell, or leave the column out with channels=(...).",
        )

    def _lines(self) -> list[tuple[int, str]]:
        """Return the lines with something in them, with their numbers."""
        lines = enumerate(self._body.split("\n"), start=self._first_line)
        return [(number, line) for number, line in lines if line.strip()]

    def row(self, i: int) -> str:
        """Return the line of the file that row `i` is from."""
        return f"line {self._lines()[i][0]}"


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


def _decoded(content: bytes, source: str, encoding: str) -> str:
    if encoding == "utf-8":
        if content.startswith(UTF16_MARKS):
            raise RecordingError(
                f"{source!r} is written in UTF-16.",
                (source,),
                'Give encoding="utf-16", or save it as UTF-8.',
            )
        encoding = "utf-8-sig"
    try:
        return content.decode(encoding)
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise RecordingError(
            f"Line {line} of {source!r} has the byte {content[error.start]:#04x}, "
            f"which is not {error.encoding.upper()} text.",
            (source,),
            'Save it as UTF-8, or give its encoding, as encoding="latin-1".',
        ) from error
    except LookupError as error:
        raise RecordingError(
            f"There is no encoding {encoding!r}.",
            (encoding,),
            "Write utf-8, utf-16 or latin-1.",
        ) from error
