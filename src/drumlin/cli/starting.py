"""Commands for writing a first brake file.

One command prints example brakes. Another prints the JSON schema by which an editor completes keys.
"""

import json
from typing import Annotated

import typer

from drumlin.base.errors import BadInput
from drumlin.base.texts import did_you_mean_hint
from drumlin.cli.terminal import print_names_beside_texts, print_text_unchanged


def init(
    name: Annotated[
        str | None,
        typer.Argument(metavar="[NAME]", help="an example; without one they are listed"),
    ] = None,
) -> None:
    """List the example brakes, or print one of them: drumlin init double_shoe > my.toml."""
    import tomllib

    from drumlin.studies import paths_of_example_brakes, text_of_example_brake

    if name is not None:
        print_text_unchanged(text_of_example_brake(name))
        return
    titles = {
        key: tomllib.loads(path.read_text(encoding="utf-8"))["title"]
        for key, path in paths_of_example_brakes().items()
    }
    print_names_beside_texts(titles)


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
