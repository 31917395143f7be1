"""The manual is complete, describes every public name, and its examples and links hold."""

import ast
import base64
import importlib
import inspect
import io
import re

import nbformat
import pytest
from docutils.core import publish_doctree
from PIL import Image
from PIL.PngImagePlugin import PngInfo
from sphinx.ext.napoleon import Config, NumpyDocstring

import command_line
import drumlin
from browsing import browser
from conftest import ROOT
from drumlin.base.errors import NoAnswer
from drumlin.brake.fields import PartOfInputFile
from drumlin.brake.schema import json_schema_of_brake_file
from drumlin.models import MODELS
from drumlin.studies import import_study_and_find_folder_above_studies, paths_of_example_brakes
from drumlin.sweeps.schema import json_schema_of_sweep_file
from drumlin_studies import notebooks
from picking import picked

manual = import_study_and_find_folder_above_studies("manual")[0]
listing = manual.listing
solve_path = importlib.import_module("studies.manual.solve_path")
built_pages = importlib.import_module("studies.manual.built_pages")
docstrings = importlib.import_module("studies.manual.docstrings")
gallery = importlib.import_module("studies.manual.gallery")
QUOTED = importlib.import_module("studies.manual.values").QUOTED
PAGES = ROOT / "studies" / "manual" / "pages"
NOTEBOOKS = sorted((ROOT / "studies" / "notebooks").glob("*.ipynb"))


# the reference


def parts(kind=PartOfInputFile):
    for below in kind.__subclasses__():
        yield below
        yield from parts(below)


def test_every_key_of_every_file_is_described():
    listed = [
        kind
        for _, kind, _ in (
            *listing.KEY_MEANINGS_OF_BRAKE_FILE_PARTS,
            *listing.MEANINGS_OF_SWEEP_FILE_KEYS,
        )
    ]
    here = {
        kind for kind in parts() if kind.__module__.startswith(("drumlin.brake", "drumlin.sweeps"))
    }
    in_no_file = {
        "ShoeBodyOfConstantSection",
        "ContactOptions",
        "Distribution",
        "DrumLiningRow",
        "SupportedShoe",
        "Brake",
        "Lining",
        "ShoeWithOptionalMeshFile",
        "ShoePattern",
        "Shoe",
    }
    assert set(picked(here - set(listed), "__name__")) == in_no_file
    assert len(listed) == len(set(listed))
    text = listing.brake_file_page() + listing.sweep_file_page()
    for kind in listed:
        for name, field in kind.model_fields.items():
            assert f"| `{field.alias or name}` |" in text


def test_a_key_without_words_or_words_without_key_fails(monkeypatch):
    heading, kind, words = listing.KEY_MEANINGS_OF_BRAKE_FILE_PARTS[0]
    monkeypatch.setattr(
        listing, "KEY_MEANINGS_OF_BRAKE_FILE_PARTS", [(heading, kind, words | {"colour": "none"})]
    )
    with pytest.raises(ValueError, match="colour"):
        listing.brake_file_page()
    monkeypatch.setattr(
        listing, "KEY_MEANINGS_OF_BRAKE_FILE_PARTS", [(heading, kind, {"title": "words"})]
    )
    with pytest.raises(KeyError, match="rotation"):
        listing.brake_file_page()


def test_an_editor_shows_the_meaning_of_every_key():
    """The schema of brake files has for each key the meaning that the manual prints."""
    parts = json_schema_of_brake_file()["$defs"]
    in_schema = {
        "DrumBrake": "Brake",
        "DrumShoe": "Shoe",
        "DrumLining": "Lining",
        "ArcBody": "Body",
    }
    seen = 0
    for _, kind, meanings in listing.KEY_MEANINGS_OF_BRAKE_FILE_PARTS:
        keys = parts[in_schema.get(kind.__name__, kind.__name__)]["properties"]
        assert set(keys) == set(meanings)
        for key, schema in keys.items():
            assert schema["description"].startswith(meanings[key])
            seen += 1
    assert seen > 150
    radius = parts["Drum"]["properties"]["radius"]["description"]
    assert radius.endswith("(a length with its unit, such as '8 mm')")
    sweep = json_schema_of_sweep_file()["properties"]
    assert sweep["seed"]["description"] == "seed of the random draws"
    options = sweep["model"]["properties"]["fem"]["properties"]
    assert options["elements"]["description"] == "number of elements along each lining"


def test_a_value_says_its_kind_unit_and_limits():
    text = listing.brake_file_page()
    assert '| `radius` | a length such as `"8 mm"`, > 0; required |' in text
    assert "| `friction` | a number or a table, ≥ 0, ≤ 1e+06; required |" in text
    # The default of `blocks` is given in words, not as a number.
    assert '| `blocks` | rows like `["55 deg", "8 mm"]`; may be left out |' in text
    assert '| `blocks` | rows like `["8 mm", "8 mm"]`; may be left out |' in text
    assert (
        '| `clearance` | a length such as `"8 mm"`, or rows like `["55 deg", "8 mm"]`; default'
        in text
    )
    assert '| `support` | `"fixed"` or `"free"`; default `fixed` |' in text


def test_every_command_and_option_is_listed():
    import typer

    from drumlin.cli.commands import app

    text = listing.commands_page()
    for name, command in vars(typer.main.get_command(app))["commands"].items():
        assert f"## `drumlin {name} " in text
        for param in command.params:
            for option in [o for o in param.opts if o.startswith("--") and o != "--help"]:
                assert f"`{option}`" in text


@pytest.mark.parametrize(
    "path",
    ["double_shoe/brake.toml", "post_brake/brake.toml", "laws/pivoted_block.toml", "laws/pad.toml"],
)
def test_every_quantity_of_a_response_has_its_formula(path):
    page = (PAGES / "reference" / "quantities.md").read_text()
    brake = drumlin.read_brake(ROOT / "studies" / path)
    for name, model in MODELS.items():
        if model.why_not(brake) is None:
            coarse = {"fem": {"elements": 6}, "solid": {"across": 1}}
            data = drumlin.solve(brake, name, **coarse.get(name, {})).as_dict()
            for key in [*data, *data["shoes"][0]]:
                assert f"`{key}`" in page, f"{key} of {name}"


# public names


def test_every_public_name_has_a_docstring():
    missing = []
    for path in sorted((ROOT / "src").rglob("*.py")):
        tree = ast.parse(path.read_text())
        missing += (
            [str(path)] if ast.get_docstring(tree) is None and path.read_text().strip() else []
        )
        for node, owner in public(tree):
            if ast.get_docstring(node) is None:
                missing.append(f"{path.relative_to(ROOT)}: {owner}{node.name}")
    assert not missing


def public(tree, owner=""):
    """Public functions, classes and methods; an overriding method counts with the first one."""
    for node in tree.body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and not node.name.startswith("_"):
            yield node, owner
            if isinstance(node, ast.ClassDef) and not node.bases:
                yield from public(node, f"{node.name}.")


FUNCTIONS = [name for name in drumlin.__all__ if inspect.isfunction(getattr(drumlin, name))]


@pytest.mark.parametrize("name", FUNCTIONS)
def test_the_doors_functions_say_what_they_take_return_and_raise(name):
    function = getattr(drumlin, name)
    words = inspect.getdoc(function)
    for heading in ("Parameters", "Returns", "Raises"):
        assert f"\n{heading}\n{'-' * len(heading)}\n" in words
    for parameter in inspect.signature(function).parameters:
        assert re.search(rf"^{parameter} : ", words, re.M), parameter


def test_every_public_name_has_a_page():
    pages = listing.api_pages()
    for name in drumlin.__all__:
        if not name.startswith("_"):
            assert f":: drumlin.{name}\n" in pages[f"reference/api/{name}.rst"]
            assert f"(api/{name}.rst)" in pages["reference/api.md"]
    # The classes of results that only a function returns stand on the page of the function.
    for result in ("SelfLockingFrictionsOfBrake", "SelfLockingFrictionOfGroup"):
        assert f".. autoclass:: drumlin.door.{result}\n" in pages["reference/api/self_locking.rst"]
    # Modules of examples and those for researchers have pages, the others stand in a table.
    for module in ("drumlin.models", "drumlin.fem.model", "drumlin.contact.active_set"):
        assert f".. automodule:: {module}\n" in pages[f"reference/api/{module}.rst"]
    for module in listing.public_modules():
        if listing.public_members(module):
            has_page = f"[`{module}`](api/{module}.rst)" in pages["reference/api.md"]
            assert has_page or f"`{module}`" in pages["reference/api.md"]
            assert has_page or module.split(".")[1] not in listing.ROOMS_WITH_PAGES


def test_the_meaning_of_a_parameter_stands_below_its_name():
    lines = inspect.getdoc(drumlin.solve).splitlines()
    docstrings.prepare_docstring(None, "function", "solve", drumlin.solve, None, lines)
    at = lines.index("brake")
    assert lines[at + 1] == "    the brake, or the path of its file"
    # The annotation has the type of the result, and no word of the text is taken as a type.
    assert any(line.startswith(":returns: ") for line in lines) and "Returns" not in lines
    assert "Response" not in lines


def test_the_words_of_a_property_are_no_type():
    """napoleon would take what stands before the colon as the type of the property."""
    lines = ["The mass matrix (n, n) [m^2] of the nodes: weighted gaps.", ""]
    docstrings.prepare_docstring(None, "property", "M", None, None, lines)
    config = Config(napoleon_google_docstring=False)
    text = NumpyDocstring(lines, config, what="property", name="M").lines()
    assert text[:2] == ["The mass matrix (n, n) [m^2] of the nodes:", "weighted gaps."]
    assert not any(line.startswith(":type:") for line in text)


@pytest.mark.slow
def test_docutils_reads_every_docstring_of_a_page():
    """Indentation or marks that docutils does not read end the build of the manual."""
    config = Config(napoleon_google_docstring=False, napoleon_use_ivar=True)
    read = 0
    for module in listing.public_modules():
        members = listing.public_members(module)
        if module.split(".")[1] not in listing.ROOMS_WITH_PAGES:
            continue
        for name, value in members:
            lines = inspect.getdoc(value).splitlines()
            kind = "class" if inspect.isclass(value) else "function"
            docstrings.prepare_docstring(None, kind, name, value, None, lines)
            text = "\n".join(NumpyDocstring(lines, config, what=kind, name=name).lines())
            said = io.StringIO()
            options = {"warning_stream": said, "report_level": 2}
            publish_doctree(re.sub(r":\w+:(\w+:)?`", "`", text), settings_overrides=options)
            assert "ndent" not in said.getvalue() and "without end" not in said.getvalue(), name
            read += 1
    assert read > 400


# the examples, and the error messages


def test_every_example_has_its_place_in_the_gallery(tmp_path, monkeypatch):
    assert set(gallery.EXAMPLES) == set(paths_of_example_brakes())
    kinds = {path.stem for path in (PAGES / "kinds").glob("*.md")}
    assert {shown.kind for shown in gallery.EXAMPLES.values()} == kinds
    text = gallery._gallery_text()
    section = gallery._section_of_example("rail_clamp", paths_of_example_brakes()["rail_clamp"])
    assert "(kinds/plane.md#rail_clamp)" in text
    assert "(rail_clamp)=" in section
    # The page has what its commands print.
    init, solve = re.findall(r"(?m)^drumlin (.*)$", section)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "my.toml").write_text(command_line.drumlin(*init.split()[:2]).stdout)
    printed = command_line.drumlin(*solve.split()).stdout.rstrip()
    assert printed and printed in section


def test_troubleshooting_has_words_of_messages():
    """Each quoted part of a message is a text of the code."""
    source = ""
    for path in (ROOT / "src" / "drumlin").rglob("*.py"):
        # A text of the code may be written in two pieces.
        source += re.sub(r'"\s+f?"', "", path.read_text(encoding="utf-8"))
    page = (PAGES / "troubleshooting.md").read_text(encoding="utf-8")
    words = re.findall(r"(?m)^\| `(.*?)` \|", page)
    assert len(words) > 15
    assert [word for word in words if word not in source] == []


# notebooks


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_has_no_traces_of_a_run_and_uses_the_door_alone(path):
    notebook = nbformat.read(path, as_version=4)
    assert set(notebook.metadata) == {"kernelspec"}
    text = path.read_text(encoding="utf-8")
    assert "/tmp/" not in text and str(ROOT) not in text and "<Figure size" not in text
    numbers = [cell.execution_count for cell in notebook.cells if cell.cell_type == "code"]
    assert numbers == list(range(1, len(numbers) + 1))
    for cell in notebook.cells:
        if cell.cell_type == "code":
            assert not cell.metadata
            tree = ast.parse(cell.source)
            for node in ast.walk(tree):
                names = (
                    picked(node.names, "name")
                    if isinstance(node, ast.Import | ast.ImportFrom)
                    else []
                )
                assert not (getattr(node, "module", None) or "").startswith("drumlin")
                assert not any(name.startswith("drumlin.") for name in names)
                if (
                    isinstance(node, ast.Attribute)
                    and isinstance(node.value, ast.Name)
                    and node.value.id == "drumlin"
                ):
                    assert node.attr in drumlin.__all__


@pytest.mark.slow
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
@pytest.mark.filterwarnings("ignore::RuntimeWarning", "ignore::DeprecationWarning")
def test_a_notebook_prints_what_is_kept(path):
    """The kept outputs of a notebook are those of its cells, but for round-off."""
    kept, made = nbformat.read(path, as_version=4), notebooks.execute_notebook(path)
    pairs = list(
        zip(notebooks.texts_of_outputs(kept), notebooks.texts_of_outputs(made), strict=True)
    )
    for old, new in pairs:
        assert same_text(old, new), f"make notebooks writes {new!r} in place of {old!r}"
    assert sum(bool(old) for old, _ in pairs) >= 5
    for old, new in zip(kept.cells, made.cells, strict=True):
        kinds = [[set(one.get("data", ())) for one in c.get("outputs", ())] for c in (old, new)]
        assert kinds[0] == kinds[1]
        assert not old.source.startswith("response.plot") or "image/png" in kinds[0][0]


def same_text(old, new):
    """Whether two printed texts have the same words, and numbers that differ by round-off."""
    (words, numbers), (new_words, new_numbers) = map(
        notebooks.text_with_stars_for_numbers_and_its_numbers, (old, new)
    )
    return words == new_words and new_numbers == pytest.approx(numbers, rel=1e-3, abs=1e-8)


def test_another_number_or_word_in_a_notebook_is_noticed():
    assert same_text("torque 447.6 N m, off by -4.6e-14", "torque 447.5 N m,\noff by +1.2e-14")
    assert not same_text("torque 447.6 N m", "torque 448.6 N m")
    assert not same_text("torque 447.6 N m", "force 447.6 N m")


def test_another_number_in_a_table_of_html_is_noticed():
    """The manual shows the HTML of a value, also where its plain text is the same."""
    cell = nbformat.v4.new_code_cell()
    data = {"text/html": "<td>447.6</td><td>2448</td>", "text/plain": "torque"}
    cell.outputs = [nbformat.v4.new_output("execute_result", data=data)]
    (old,) = notebooks.texts_of_outputs(nbformat.v4.new_notebook(cells=[cell]))
    assert notebooks.text_with_stars_for_numbers_and_its_numbers(old) == (
        "torque * *",
        [447.6, 2448],
    )
    data["text/html"] = "<td>447.6</td><td>2453</td>"
    cell.outputs = [nbformat.v4.new_output("execute_result", data=data)]
    (new,) = notebooks.texts_of_outputs(nbformat.v4.new_notebook(cells=[cell]))
    assert same_text(old, old) and not same_text(old, new)


def test_a_picture_is_kept_without_the_version_of_matplotlib():
    """Its texts are removed, its pixels stay, and those of the kept notebooks have none."""
    drawn = io.BytesIO()
    about = PngInfo()
    about.add_text("Software", "Matplotlib version 3.0")
    about.add_text("Title", "packed", zip=True)
    about.add_itxt("Comment", "in Unicode")
    pixels = bytes(range(48))
    Image.frombytes("RGB", (4, 4), pixels).save(drawn, "png", pnginfo=about)
    assert b"Matplotlib" in drawn.getvalue() and len(Image.open(drawn).info) == 3
    data = {"image/png": base64.b64encode(drawn.getvalue()).decode(), "text/plain": "<Figure>"}
    output = nbformat.v4.new_output("display_data", data=data)
    notebooks._remove_traces_of_run_from_output(output, 1)
    kept = Image.open(io.BytesIO(base64.b64decode(output.data["image/png"])))
    assert kept.info == {} and kept.tobytes() == pixels and set(output.data) == {"image/png"}
    with pytest.raises(ValueError, match="no PNG file"):
        notebooks.png_without_texts(b"GIF89a")
    seen = 0
    for path in NOTEBOOKS:
        for cell in nbformat.read(path, as_version=4).cells:
            for output in cell.get("outputs", ()):
                if "image/png" in output.get("data", {}):
                    picture = base64.b64decode(output.data["image/png"])
                    assert notebooks.png_without_texts(picture) == picture
                    seen += 1
    assert seen >= 3


CELL = re.compile(r"^```\{code-cell\}\n(.*?)^```", re.MULTILINE | re.DOTALL)
"""A cell of a page, which is run as the manual is built."""


@pytest.mark.parametrize(
    "page",
    [
        "researcher/contact",
        "researcher/ladder",
        "researcher/new_brake",
        "researcher/new_model",
        "researcher/python",
        "engineer/play",
    ],
)
def test_cells_of_pages_that_call_inner_functions_run(page, monkeypatch, tmp_path):
    """These cells call functions of all rooms, whose names may change."""
    monkeypatch.setenv("MPLBACKEND", "agg")
    monkeypatch.chdir(tmp_path)
    cells = CELL.findall((PAGES / f"{page}.md").read_text(encoding="utf-8"))
    names: dict[str, object] = {}
    for cell in cells:
        code = "\n".join(line for line in cell.splitlines() if not line.startswith(":"))
        exec(compile(code, page, "exec"), names)
    assert cells


# the site

EXECUTED = "---\nfile_format: mystnb\nkernelspec:\n  name: python3\n---\n"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("# A\n\n[gone](nowhere.md)\n", "nowhere"),
        ("# A\n\n[gone](#no-such-heading)\n", "no-such-heading"),
        ("# A\n\n![gone](picture.png)\n", "picture.png"),
        ("# A\n\n<a href='gone.html'>gone</a>\n", "dead link gone.html"),
        (
            f"{EXECUTED}# A\n\n```{{code-cell}}\n1 / 0\n```\n",
            "ZeroDivision",
        ),
        (
            f"{EXECUTED}# A\n\n```{{code-cell}}\n!drumlin solve gone.toml\n```\n",
            "a command that fails",
        ),
    ],
    ids=["page", "heading", "picture", "link", "example", "command"],
)
@pytest.mark.slow
def test_what_is_broken_fails_the_manual(tmp_path, text, said):
    (tmp_path / "pages").mkdir()
    (tmp_path / "pages" / "index.md").write_text(text)
    with pytest.raises(NoAnswer, match=said):
        manual.build_site(tmp_path / "pages", tmp_path / "site")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("<p>torque \x1b[1m447\x1b[0m N m</p>", "control code"),
        ("<p>torque [1m447[0m N m</p>", "control code"),
        ("<pre>?25l\nsolving by fem</pre>", "control code"),
        ("<pre>⠙ solving by fem</pre>", "spinner"),
        ("<pre>&lt;Figure size 660x660 with 1 Axes&gt;</pre>", "not drawn"),
        ("<pre>&lt;drumlin.Brake object at 0x7f3a&gt;</pre>", "not drawn"),
        ("<math><mi>\\sqrt</mi></math>", "TeX"),
        ("<pre>\n!drumlin init</pre>", "mark of a notebook"),
        ("<pre>\n%%writefile sweep.toml</pre>", "mark of a notebook"),
        ("<a href='gone.html'>gone</a>", "dead link gone.html"),
        ("<a href='#gone'>gone</a>", "dead link #gone"),
        ("<script src='https://elsewhere.org/x.js'></script>", "loads https"),
        ("<img src='gone.png'>", "loads gone.png"),
    ],
)
def test_a_wrong_page_is_noticed(tmp_path, text, said):
    good = "<p id='here'>447 N m</p><a href='#here'>here</a><a href='index.html#here'>here</a>"
    (tmp_path / "index.html").write_text(good)
    assert built_pages.faults_of_built_pages(tmp_path) == []
    (tmp_path / "index.html").write_text(good + text)
    (fault,) = built_pages.faults_of_built_pages(tmp_path)
    assert said in fault


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The built manual."""
    with pytest.MonkeyPatch.context() as patch:
        # The command line sets this backend, too.
        patch.setenv("MPLBACKEND", "agg")
        return manual.report(manual.study(), tmp_path_factory.mktemp("manual")).parent


@pytest.mark.slow
def test_the_manual_is_built_whole_and_stands_alone(site):
    # The build itself refuses dead links, control codes and pictures that are not drawn.
    # A search lists pages of modules last.
    assert "reference/api/drumlin." in (site / "_static" / "language_data.js").read_text()
    pages = list(site.rglob("*.html"))
    assert len(pages) > 40
    text = (site / "engineer" / "table.html").read_text(encoding="utf-8")
    torque = drumlin.solve(
        drumlin.read_brake(ROOT / "studies" / "double_shoe" / "brake.toml")
    ).torque
    # The number on the page was computed when the page was built.
    assert f"{torque:.6g}" in text
    for function in FUNCTIONS:
        page = (site / "reference" / "api" / f"{function}.html").read_text(encoding="utf-8")
        assert f'id="drumlin.{function}"' in page
    for name in ("engineer/table", "engineer/which_law", "researcher/python", "notebooks/engineer"):
        # These are the figures of the manual's examples.
        assert "_images/" in (site / f"{name}.html").read_text(encoding="utf-8")
    assert "<math" in (site / "researcher" / "contact.html").read_text(encoding="utf-8")
    index = (site / "searchindex.js").read_text(encoding="utf-8")
    for word in ("lock", "servo", "park", "cite", "bsd", "cam"):
        assert f'"{word}' in index or f"{word}:" in index, word
    assert not list(site.rglob("*.pickle"))


# The elements that reach beyond the right edge of the window, and within nothing that scrolls.
CUT = """
const scrolls = (one) => one && one !== document.body &&
  (getComputedStyle(one).overflowX !== "visible" || scrolls(one.parentElement));
const cut = (one) => one.getBoundingClientRect().right > innerWidth + 1 && !scrolls(one);
const found = [...document.querySelectorAll("article *")].filter(cut).map((one) => one.outerHTML);
return document.documentElement.scrollWidth > innerWidth + 1 ? [...found, "the page"] : found;
"""


@pytest.mark.slow
@pytest.mark.parametrize("width", [1280, 400])
def test_pages_of_the_manual_fit_on_wide_and_narrow_screens(site, tmp_path, width):
    """Nothing is cut, and wide tables and examples scroll within the page."""
    pages = [page for page in sorted(site.rglob("*.html")) if "drumlin." not in page.name]
    assert len(pages) > 40
    with browser(tmp_path) as window:
        size = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False}
        window.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
        for page in [*pages, site / "reference" / "api" / "drumlin.solve.html"]:
            window.get(page.as_uri())
            assert window.execute_script(CUT) == [], page.name
        assert [line for line in window.get_log("browser") if line["level"] == "SEVERE"] == []


# values that pages quote


def test_every_value_is_quoted_and_every_quote_has_a_value():
    known = manual.quoted_values()
    quoted = set()
    for page in PAGES.rglob("*.md"):
        quoted |= set(QUOTED.findall(page.read_text(encoding="utf-8")))
    assert quoted == set(known)
    assert known["penalty"] == "1e8"
    assert manual.fill_in_values("with {{ penalty }}", known) == "with 1e8"
    # The braces of an f-string in an example are no quote.
    assert manual.fill_in_values("{{ from = 0.1 }}", known) == "{{ from = 0.1 }}"
    with pytest.raises(NoAnswer, match="no value is called 'nonsense'"):
        manual.fill_in_values("{{ nonsense }}", known)


# the architecture page

ARCHITECTURE = (PAGES / "researcher" / "architecture.md").read_text(encoding="utf-8")
# Largest number of source files that a change touches, but for friction that depends on pressure.
MOST_FILES = 5


def test_the_architecture_page_has_every_room():
    source = ROOT / "src" / "drumlin"
    rooms = {path.parent.relative_to(source) for path in source.rglob("__init__.py")}
    for room in rooms:
        # The rooms fem and verification list their own rooms; the others stand alone.
        if room.parts and (len(room.parts) == 1 or room.parts[0] == "fem"):
            name = ".".join(("drumlin", *room.parts))
            assert f"`{name}`" in ARCHITECTURE, name
    for name in solve_path.rooms_in_picture():
        importlib.import_module(name)


def test_the_ten_changes_name_files_that_exist_and_touch_few():
    _, _, section = ARCHITECTURE.partition("## What a change touches\n")
    paragraphs = [text for text in section.split("\n\n") if text.startswith("**")]
    changes = {}
    for text in paragraphs:
        _, what, told = text.split("**", 2)
        # Each file counts once, however often a paragraph names the file.
        changes[what] = set(re.findall(r"`([\w/]+\.(?:py|json))`", told))
    assert len(changes) == 10
    for what, files in changes.items():
        assert files, what
        for file in files:
            assert (ROOT / "src" / "drumlin" / file).exists(), f"{what}: {file}"
        assert len(files) <= MOST_FILES or "μ(p)" in what, what


# names that texts mention

DOTTED = re.compile(r"`((?:[a-z_]\w*\.)+\w+)(?:\(.*?\))?`")
"""A dotted name in single back quotes: `drumlin.brake.surface` or
`adapt.DEFAULT_TOLERANCES_OF_PRESSURE_AND_TORQUE`.
"""
FILE = re.compile(r"(?<![\w./{])((?:[a-z_]\w*/)*[a-z_]\w*\.py)\b")
"""The path of a Python file in a text."""
NOT_OURS = (
    "brake.toml",
    "make.",
    "np.",
    "numpy.",
    "scipy.",
    "math.",
    "matplotlib.",
    "shoe.",
    "drum.",
)
"""First words of names in back quotes that are files, other libraries or keys of a brake file."""


def modules():
    """Modules of both packages by each ending of their names: `adapt`, `error_control.adapt`."""
    found = {}
    for package in ("drumlin", "drumlin_studies"):
        for path in (ROOT / "src" / package).rglob("*.py"):
            # Texts must not use the old name of a module that has moved.
            if "__getattr__ = moved(" in path.read_text(encoding="utf-8"):
                continue
            parts = path.relative_to(ROOT / "src").with_suffix("").parts
            parts = parts[:-1] if parts[-1] == "__init__" else parts
            for start in range(len(parts)):
                found.setdefault(".".join(parts[start:]), []).append(".".join(parts))
    return found


MODULES = modules()


def is_there(name):
    """Whether a dotted name is a module, or a name in a module or in a class of a module."""
    parts = name.split(".")
    for end in range(len(parts), 0, -1):
        for module in MODULES.get(".".join(parts[:end]), ()):
            value: object = importlib.import_module(module)
            for part in parts[end:]:
                fields = getattr(value, "__annotations__", {})
                value = getattr(value, part, fields.get(part))
            if value is not None:
                return True
    return False


def mentioned():
    """Place and dotted name of each mention in a page of the manual or in a docstring."""
    for page in [*PAGES.rglob("*.md"), ROOT / "README.md", ROOT / "CONTRIBUTING.md"]:
        prose = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.S)
        yield from ((page.name, name) for name in DOTTED.findall(prose))
    for path in sorted((ROOT / "src").rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
                text = node.value.value
                if isinstance(text, str):
                    yield from ((path.name, name) for name in DOTTED.findall(text))


def test_dotted_names_in_docstrings_and_pages_exist():
    """A name in a text that begins with drumlin or with one of its modules must exist.

    Other dotted names are files, keys of a brake file, or attributes of an object in a sentence.
    """
    missing, seen = [], 0
    for place, name in mentioned():
        first = name.split(".")[0]
        if name.endswith((".py", ".md", ".toml", ".json", ".jsonl", ".csv", ".vtu")):
            continue
        if first.startswith("drumlin") or (first in MODULES and not name.startswith(NOT_OURS)):
            seen += 1
            if not is_there(name):
                missing.append(f"{place}: {name}")
    assert not missing
    assert seen > 50


def test_files_that_texts_mention_exist():
    """A path such as fem/model.py, in a docstring, a comment or a page, is the end of a file's."""
    ends = set()
    for folder in ("src", "studies", "tests", "meshes"):
        for path in (ROOT / folder).rglob("*.py"):
            parts = path.relative_to(ROOT).parts
            ends |= {"/".join(parts[start:]) for start in range(len(parts))}
    texts = [*(ROOT / "src").rglob("*.py"), *PAGES.rglob("*.md"), ROOT / "README.md"]
    missing = []
    for text in texts:
        for name in re.findall(FILE, text.read_text(encoding="utf-8")):
            if name not in ends and name != "setup.py":
                missing.append(f"{text.name}: {name}")
    assert not missing


def test_a_name_that_is_gone_is_noticed():
    assert is_there("drumlin.fem.error_control.adapt")
    assert is_there("adapt.DEFAULT_TOLERANCES_OF_PRESSURE_AND_TORQUE")
    assert is_there("drumlin.door.WearRun") or is_there("drumlin.lining_wear.whole_brake.WearRun")
    assert not is_there("drumlin.misfit")
    assert not is_there("assembly.coupled")
