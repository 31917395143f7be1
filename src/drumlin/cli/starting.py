"""Commands for writing a first brake file.

One command prints example brakes. Another prints the JSON schema by which an editor completes keys.
"""

import json
from typing import Annotated

import typer

from drumlin.base.errors import BadInput
from drumlin.base.texts import nearest
from drumlin.cli.terminal import tell, write


def init(
    name: Annotated[
        str | None, typer.Argument(metavar="[NAME]", help="an example; without one they are listed")
    ] = None,
) -> None:
    """List the example brakes, or print one of them: drumlin init double_shoe > my.toml."""
    import tomllib

    from drumlin.studies import example, examples

    if name is not None:
        write(example(name))
        return
    found = examples()
    wide = max(map(len, found))
    for key, path in found.items():
        tell(f"{key:{wide}}  {tomllib.loads(path.read_text(encoding='utf-8'))['title']}")


def schema(
    kind: Annotated[str, typer.Argument(metavar="brake|sweep", help="the kind of file")] = "brake",
) -> None:
    """Print the JSON schema of brake or sweep files.

    An editor completes a file whose first line names the schema: #:schema FILE.
    """
    from drumlin.brake.schema import brake_schema
    from drumlin.sweeps.schema import sweep_schema

    made = {"brake": brake_schema, "sweep": sweep_schema}
    if kind not in made:
        raise BadInput(
            f"KIND = {kind!r}: unknown kind of file{nearest(kind, made)}; allowed: "
            f"{', '.join(made)}"
        )
    write(json.dumps(made[kind](), indent=1, ensure_ascii=False) + "\n")
