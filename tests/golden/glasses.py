"""Writes glasses.csv: the refractiveindex.info database's values for every glass of the six makers in the library.

    python tests/golden/glasses.py DATABASE

DATABASE is the folder `database` of the repository polyanskiy/refractiveindex.info-database, at the commit that the
head of crates/optics/lenses/glasses.txt names. Each page's formula is evaluated here as the database's documentation
defines it, in 40 digits; n_d and V_d are the values that the page states. Nothing is shared with
crates/optics/lenses/glasses.py, which makes the library's table.
"""

import re
import sys
from decimal import Decimal, InvalidOperation, getcontext
from pathlib import Path

getcontext().prec = 40
# Spectral lines i, g, F, e, d, C and t, um.
LINES = ["0.3650146", "0.4358343", "0.4861327", "0.546074", "0.5875618", "0.6562725", "1.01398"]


def index(formula: int, c: list[Decimal], wavelength: Decimal) -> Decimal:
    """Returns the index by formula 1, 2 or 3; not a number if the square root does not exist."""
    square = wavelength * wavelength
    if formula == 3:
        total = c[0] + sum(c[i] * wavelength ** int(c[i + 1]) for i in range(1, len(c), 2))
    else:
        poles = [p * p if formula == 1 else p for p in c[2::2]]
        total = 1 + c[0] + sum(b * square / (square - p) for b, p in zip(c[1::2], poles, strict=True))
    return total.sqrt() if total > 0 else Decimal("NaN")


def stated(text: str, name: str) -> str:
    """Returns a number of the page's properties, if the page states it."""
    found = re.search(rf"^ +{name}: +(\S+)", text, re.MULTILINE)
    return str(float(found[1])) if found else ""


def main() -> None:
    """Writes the table."""
    rows = []
    for maker in ("cdgm", "hikari", "hoya", "ohara", "schott", "sumita"):
        for page in sorted((Path(sys.argv[1]) / "data" / "specs" / maker).glob("*/*.yml")):
            text = page.read_text(encoding="utf-8")
            found = re.search(r"- type: formula ([123])\b[\s\S]*?coefficients: (.*)", text)
            if not found:
                continue
            numbers = [Decimal(number) for number in found[2].split()]
            cells = []
            for line in LINES:
                try:
                    n = index(int(found[1]), numbers, Decimal(line))
                except InvalidOperation:
                    n = Decimal("NaN")
                cells.append("" if n.is_nan() else f"{n:.9f}")
            rows.append([maker.upper(), page.stem, stated(text, "nd"), stated(text, "Vd"), *cells])
    out = Path(__file__).with_suffix(".csv")
    head = "maker,name,n_d,V_d,i,g,F,e,d,C,t"
    out.write_text("\n".join([head, *(",".join(row) for row in rows)]) + "\n", encoding="utf-8")
    print(len(rows), "glasses")


if __name__ == "__main__":
    main()
