"""The command `drumlin explore`, which serves a page with sliders for one brake."""

from typing import Annotated

import typer

import drumlin
from drumlin.cli.options import BrakeFileArgument, parser_of_whole_number_option
from drumlin.cli.terminal import print_line_folded_to_terminal_width, print_note_to_standard_error


def explore(
    brake_file: BrakeFileArgument,
    port: Annotated[
        int,
        typer.Option(
            parser=parser_of_whole_number_option("--port"),
            metavar="<int>",
            help="of this machine; 0: any free one",
        ),
    ] = 8765,
    browser: Annotated[
        bool, typer.Option("--browser/--no-browser", help="open the page in a browser")
    ] = True,
) -> None:
    """Serve a page of this machine with sliders for a brake, its pressure and its torque.

    Ctrl-C ends it.
    """
    from drumlin.explore.serve import serve_page_of_brake

    brake = drumlin.read_brake(brake_file)

    def print_address_and_open_browser(address: str) -> None:
        """Print the page's address and, if the option --browser is on, open the page.

        The server calls this function when it begins to listen.
        """
        print_line_folded_to_terminal_width(f"{brake.title}: {address}", at_once=True)
        print_note_to_standard_error("Ctrl-C ends it")
        if browser:
            import webbrowser

            webbrowser.open(address)

    serve_page_of_brake(brake, brake_file.stem, port, print_address_and_open_browser)
