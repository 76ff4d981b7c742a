"""Writes glasses.txt, the table of built-in glasses, from the refractiveindex.info database (CC0) and from
glasses.csv.

    python crates/optics/lenses/glasses.py DATABASE SNAPSHOT

DATABASE is the folder `database` of the repository polyanskiy/refractiveindex.info-database. SNAPSHOT names the commit
and date of that repository, for the head of the table.

The database provides the makers' catalogues: every glass with a dispersion formula, which is always formula 1, 2 or 3.
Glasses that have only measured indices are left out. glasses.csv has, among others, the former glasses of SCHOTT, HOYA
and SUMITA, the glasses of LZOS and the makers' resins. Each number is written with the fewest characters that read back
to the same double.
"""

from __future__ import annotations

import csv
import html
import re
import sys
from dataclasses import dataclass, field
from pathlib import Path

HERE = Path(__file__).parent

# The database's folders, in the order of preference for a name that several makers use.
MAKERS = ("schott", "ohara", "hoya", "hikari", "cdgm", "sumita")
# Plastics taken from the database, because glasses.csv has no data from their makers.
PLASTICS = {
    "NAS-21": "other/commercial polymers/NAS-21/nk/Sultanova.yml",
    "OPTOREZ1330": "other/commercial polymers/Optorez1330/nk/Sultanova.yml",
}
# The keys of glasses.csv, each with the name of the catalogue and the source of the numbers.
OWN = {
    "T": ("SCHOTT", "SCHOTT's overview of glasses of 2019 on, as the renderer crayg has it (954306)"),
    "S": ("SCHOTT", "SCHOTT.AGF, December 2024, with its old glasses"),
    "O": ("OHARA", "OHARA, ohara.agf of 2022"),
    "H": ("HOYA", "HOYA, 2020-03-14"),
    "L": ("LIGHTPATH", "LightPath, lightpath.agf of 2022"),
    "M": ("MISC", "misc.agf of 2022 (Handbook of Optics, vol. II, and makers' sheets)"),
    "P": ("PLASTIC", "PLASTIC2022.AGF"),
    "S18": ("SCHOTT", "SCHOTT.AGF, June 2018, with its obsolete glasses"),
    "H19": ("HOYA", "HOYA, 2019-06-14, with its obsolete glasses"),
    "U20": ("SUMITA", "SUMITA, 2020-07-30, with its obsolete glasses"),
    "Z20": ("LZOS", "lzos.agf of 2020"),
    "M20": ("MISC", "misc.agf of 2020"),
    "E20": ("ZEON", "zeon.agf of 2020"),
    "A20": ("APEL", "apel.agf of 2020"),
    "G20": ("OSAKAGASCHEMICAL", "osakagaschemical.agf of 2020"),
}
ORDER = ("SCHOTT", "OHARA", "HOYA", "HIKARI", "CDGM", "SUMITA", "LZOS", "LIGHTPATH", "MISC", "PLASTIC")
ORDER += ("ZEON", "APEL", "OSAKAGASCHEMICAL")

HEAD = """\
# The built-in glasses. Made by glasses.py; do not edit.
# Snapshot of the refractiveindex.info database (CC0): {snapshot}.
# @ key CATALOGUE reference: what the glasses with that key are taken from, in the order of preference.
# Then a line a glass, sorted by name without regard to capitals, dashes, underscores and spaces, and by preference:
# name, key, range of wavelengths in um (- where none is stated), formula, constants, L in um:
# s  n^2 = 1 + sum B L^2/(L^2 - C), constants B C B C ...
# c  n^2 = 1 + A + sum B L^2/(L^2 - C), constants A B C B C ...
# k  n = A + B/L + C/L^3.5, constants A B C
# p  n^2 = sum of A L^p over even p from -8 on, constants in this order; q, r: from -10, -12 on
# =  another name of the glass that follows
"""


@dataclass
class Glass:
    """A line of the table."""

    name: str
    catalogue: str
    reference: str
    formula: str
    constants: list[float | str]
    range: tuple[str, str] | None = None


@dataclass
class Table:
    """The lines of the table, and the references of the table in order of appearance."""

    glasses: list[Glass] = field(default_factory=list)

    def text(self, snapshot: str) -> str:
        """Returns the file's text."""
        references = sorted({(ORDER.index(g.catalogue), g.catalogue, g.reference) for g in self.glasses})
        keys = {reference[1:]: key for key, reference in zip(KEYS, references, strict=False)}
        assert len(keys) == len(references), "more references than keys"
        lines = [f"@ {key} {catalogue} {reference}" for (catalogue, reference), key in keys.items()]
        seen: dict[tuple[str, str], Glass] = {}
        spelled: dict[str, str] = {}
        for glass in self.glasses:
            same = seen.setdefault((glass.catalogue, loose(glass.name)), glass)
            assert same is glass, f"{glass.name} twice in {glass.catalogue}"
            assert spelled.setdefault(loose(glass.name), glass.name.upper()) == glass.name.upper(), glass.name
        rank = {catalogue: place for place, catalogue in enumerate(ORDER)}
        for glass in sorted(self.glasses, key=lambda glass: (loose(glass.name), rank[glass.catalogue])):
            constants = " ".join(c if isinstance(c, str) else shortest(c) for c in glass.constants)
            ends = [shortest(float(end)) for end in glass.range] if glass.range else ["-"]
            head = [glass.name, keys[glass.catalogue, glass.reference], *([] if glass.formula == "=" else ends)]
            lines.append(" ".join([*head, glass.formula, constants]))
        return HEAD.format(snapshot=snapshot) + "\n".join(lines) + "\n"


KEYS = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"


def loose(name: str) -> str:
    """Returns the normalised form of a name, for comparison."""
    return re.sub(r"[-_ ]", "", name).upper()


def shortest(number: float) -> str:
    """Formats a number with the fewest characters that read back to the same double."""
    mantissa, exponent = f"{number:.16e}".split("e")
    for digits in range(17):
        mantissa, exponent = f"{number:.{digits}e}".split("e")
        if float(f"{mantissa}e{exponent}") == number:
            break
    whole = mantissa.replace(".", "")
    places = len(mantissa.split(".")[1]) if "." in mantissa else 0
    forms = [repr(number), f"{mantissa}e{int(exponent)}", f"{whole}e{int(exponent) - places}"]
    forms += [re.sub(r"^(-?)0\.", r"\1.", form) for form in forms]
    forms += [form.removesuffix(".0") for form in forms]
    return min((form for form in forms if float(form) == number), key=len)


def reference_of(text: str) -> str:
    """Returns the first reference of a page, without its links."""
    block = re.search(r"^REFERENCES: *\|\n((?:    .*\n|\n)+)", text, re.MULTILINE)
    assert block, text[:300]
    plain = html.unescape(re.sub(r"<[^>]*>", " ", block[1]))
    plain = re.split(r"\(obtained|See also|\(fit of|- *downloaded|2\)", " ".join(plain.split()))[0]
    return plain.removeprefix("1)").strip(" ,")


def entry(path: Path, name: str, catalogue: str) -> Glass | None:
    """Returns the glass that a page describes; None if the page has no formula."""
    text = path.read_text(encoding="utf-8")
    data = re.search(r"type: formula (\d+) *\n +wavelength_range: (\S+) (\S+) *\n +coefficients: (.*)\n", text)
    if not data:
        return None
    numbers = [float(number) for number in data[4].split()]
    constant, pairs = numbers[0], list(zip(numbers[1::2], numbers[2::2], strict=True))
    formula, constants = "s", []
    match int(data[1]):
        case 1 | 2 as kind:
            # Formula 1 states the resonance wavelength, formula 2 the square of that wavelength.
            for b, c in pairs:
                constants += [b, c * c if kind == 1 else c]
            if constant != 0.0:
                formula, constants = "c", [constant, *constants]
        case 3:
            by_power = {round(power): a for a, power in pairs} | {0: constant}
            lowest, highest = min(by_power), max(by_power)
            assert all(float(power).is_integer() and power % 2 == 0 for _, power in pairs), path
            formula = {-8: "p", -10: "q", -12: "r"}[lowest]
            constants = [by_power.get(power, 0.0) for power in range(lowest, highest + 1, 2)]
        case other:
            raise ValueError(f"{path}: formula {other}")
    reference = reference_of(text)
    return Glass(name, catalogue, reference, formula, list(constants), (data[2], data[3]))


def own(path: Path) -> list[Glass]:
    """Reads the glasses of glasses.csv."""
    rows = csv.DictReader(line for line in path.read_text(encoding="utf-8").splitlines() if not line.startswith("#"))
    glasses = []
    for row in rows:
        catalogue, reference = OWN[row["catalogue"]]
        limits = (row["from"], row["to"]) if row["from"] else None
        if row["formula"] == "alias":
            glasses.append(Glass(row["name"], catalogue, reference, "=", [row["constants"]]))
            continue
        numbers = [float(number) for number in row["constants"].split()]
        formula = "s"
        if row["formula"] == "schott":
            zero, two, *falling = numbers
            formula, numbers = "p", [*reversed(falling), zero, two]
        elif row["formula"] == "conrady":
            formula = "k"
        if row["note"]:
            reference += "; " + row["note"]
        glasses.append(Glass(row["name"], catalogue, reference, formula, list(numbers), limits))
    return glasses


def main() -> None:
    """Writes the table."""
    database, snapshot = Path(sys.argv[1]) / "data", sys.argv[2]
    table = Table()
    without = 0
    for maker in MAKERS:
        for path in sorted((database / "specs" / maker).rglob("*.yml")):
            if path.name == "about.yml":
                continue
            glass = entry(path, path.stem, maker.upper())
            without += glass is None
            table.glasses += [glass] if glass else []
    count = len(table.glasses)
    for name, page in PLASTICS.items():
        glass = entry(database / page, name, "PLASTIC")
        assert glass, page
        table.glasses.append(glass)
    table.glasses += own(HERE / "glasses.csv")
    text = table.text(snapshot)
    (HERE / "glasses.txt").write_text(text, encoding="utf-8")
    print(
        f"{count} glasses of {len(MAKERS)} makers ({without} without a formula), {len(table.glasses)} lines, {len(text)} bytes"
    )


if __name__ == "__main__":
    main()
