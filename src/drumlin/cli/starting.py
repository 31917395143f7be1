"""Commands for writing a first brake file.

One command prints example brakes. Another prints the JSON schema by which an editor completes keys.
"""

import json
from pathlib import Path
from typing import Annotated

import typer

from drumlin.base.errors import BadInput
from drumlin.base.texts import did_you_mean_hint
from drumlin.cli.terminal import (
    print_line_folded_to_terminal_width,
    print_names_beside_texts,
    print_text_unchanged,
)


def init(
    name: Annotated[
        str | None,
        typer.Argument(metavar="[NAME]", help="an example; without one they are listed"),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="write the example and the files that it names there"),
    ] = None,
) -> None:
    """List the examples (brakes, sweeps, notebooks), or print one: drumlin init duplex > my.toml.

    With --output the example, its meshes, the brake of a sweep and the JSON schema are written.
    """
    from drumlin.studies import (
        text_of_example,
        titles_of_all_examples,
        write_example_with_its_files,
    )

    if name is None:
        print_names_beside_texts(titles_of_all_examples())
    elif output is None:
        print_text_unchanged(text_of_example(name))
    else:
        for path in write_example_with_its_files(name, output):
            print_line_folded_to_terminal_width(f"written: {path}")


def schema(
    kind: Annotated[str, typer.Argument(metavar="brake|sweep", help="the kind of file")] = "brake",
) -> None:
    """Print the JSON schema of brake or sweep files.

    An editor completes a file whose first line names the schema: #:schema FILE.
    """
    from drumlin.brake.schema import json_schema_of_brake_file
    from drumlin.sweeps.schema import json_schema_of_sweep_file

    made = {"brake": json_schema_of_brake_file, "sweep": json_schema_of_sweep_file}
    if kind not in made:
        raise BadInput(
            f"KIND = {kind!r}: unknown kind of file{did_you_mean_hint(kind, made)}; allowed: "
            f"{', '.join(made)}"
        )
    print_text_unchanged(json.dumps(made[kind](), indent=1, ensure_ascii=False) + "\n")
