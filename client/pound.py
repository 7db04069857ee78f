"""Pounding studies and sensitivity indices from Python, by the command `pound` or by a server.

    import pound
    result = pound.run(study)                        # the result as a dict; url= for a server
    Si = pound.salib(result, "impulse", cell=0)      # S1, S1_conf, ST, ...: arrays of NumPy
    rows = pound.table(result)                       # one dict per cell, output and input, or gap: pandas.DataFrame(rows)
    X = pound.design(model)                          # the rows to run a model of your own on
    Si = pound.salib(pound.indices(model, Y), "y")   # Y: what it gave for them

A study or a model is a dict, or the text of a JSON document.  The command is looked for in PATH, or where POUND says; a
server's token is taken from POUND_TOKEN.  What is wrong with a study is an Error with every fault in its text.
"""
import csv
import io
import json
import os
import subprocess
import tempfile
import urllib.error
import urllib.request

__all__ = ["Error", "run", "design", "indices", "table", "salib"]

WAIT_S = 30  # a server is asked for a change of the status, and answers after so long if there is none


class Error(Exception):
    """What `pound` or the server refuses or cannot do: one fault per line."""


def _text(study):
    return study if isinstance(study, str) else json.dumps(study, allow_nan=False)


def _command(arguments, text):
    """Standard output of `pound`, which gets a document on standard input."""
    command = os.environ.get("POUND", "pound")
    try:
        done = subprocess.run([command, *arguments], input=text, capture_output=True, text=True, encoding="utf-8")
    except OSError as fault:
        raise Error(f"{command}: {fault.strerror}; set POUND to the path of the command") from None
    if done.returncode != 0:
        raise Error(done.stderr.strip())
    return done.stdout


def _ask(url, path, body=None, headers=None):
    """Status, headers and JSON of an answer; 304 is one."""
    headers = dict(headers or {})
    if "POUND_TOKEN" in os.environ:
        headers["Authorization"] = "Bearer " + os.environ["POUND_TOKEN"]
    if body is not None:
        headers["Content-Type"] = "application/json"
    request = urllib.request.Request(url.rstrip("/") + path, body, headers)
    try:
        with urllib.request.urlopen(request) as answer:
            return answer.status, answer.headers, json.load(answer)
    except urllib.error.HTTPError as refusal:
        if refusal.code == 304:
            return 304, refusal.headers, None
        text = refusal.read().decode("utf-8", "replace")
        try:
            problem = json.loads(text)
        except ValueError:
            raise Error(f"{url}: {refusal.code} {text}") from None
        faults = [f"  {fault['pointer']}: {fault['detail']}" for fault in problem.get("errors", [])]
        raise Error("\n".join([f"{url}: {problem['detail']}", *faults])) from None
    except urllib.error.URLError as fault:
        raise Error(f"{url}: {fault.reason}") from None


def _served(url, text):
    """The result of a study that a server computes."""
    _, headers, status = _ask(url, "/v1/studies", text.encode("utf-8"))
    links = status["links"]
    while status["status"] in ("queued", "running"):
        known = {"If-None-Match": headers["ETag"], "Prefer": f"wait={WAIT_S}"}
        code, new, answer = _ask(url, links["self"], headers=known)
        if code == 200:
            headers, status = new, answer
    if status["status"] != "succeeded":
        raise Error(f"{url}: the study {status['id']} has {status['status']}: {status['error']}")
    return _ask(url, links["results"])[2]


def run(study, url=None, threads=None):
    """The result of a study as a dict: computed here by the command, with so many threads, or by the server at `url`."""
    if url:
        return _served(url, _text(study))
    options = ["--threads", str(threads)] if threads else []
    return json.loads(_command(["run", *options, "-"], _text(study)))


def _mixtures(model):
    """Names of the inputs; samples of a row in our order (A, B, AB_1 ..., BA_1 ...), as places in that of SALib
    (A, AB_1 ..., BA_1 ..., B)."""
    document = json.loads(_text(model))
    how = document.get("design", {})
    n = len(document["inputs"])
    if how.get("order") == "factorial":
        raise Error("SALib has no order for design.order \"factorial\"")
    both = how.get("order") == "second" or how.get("estimator") == "azzini_rosati"
    n_mixed = 2 * n if both else n
    return [0, n_mixed + 1, *range(1, n_mixed + 1)]


def _order(name):
    if name not in ("pound", "salib"):
        raise Error(f"order must be \"pound\" or \"salib\", got {name!r}")
    return name == "salib"


def design(model, order="pound"):
    """The rows of a design to run a model on: an array (samples, inputs).  order="salib": as SALib.sample.sobol has them."""
    import numpy

    lines = _command(["design", "-"], _text(model)).split("\n", 1)[1]
    rows = numpy.loadtxt(io.StringIO(lines), delimiter=",", ndmin=2)
    if not _order(order):
        return rows
    places = _mixtures(model)
    moved = numpy.empty_like(rows).reshape(-1, len(places), rows.shape[1])
    moved[:, places, :] = rows.reshape(moved.shape)
    return moved.reshape(rows.shape)


def indices(model, outputs, names=None, order="pound"):
    """The result, as of a sensitivity study, of the outputs that a model gave for the rows of its design.

    outputs  array (samples,) or (samples, outputs), in the order of design(model, order); NaN: a failed run
    names    of the outputs, with NAME.variance for the variance of a mean over replicates; default: y, or y1, y2, ...
    """
    import numpy

    columns = numpy.asarray(outputs, dtype=float)
    columns = columns.reshape(len(columns), -1)
    n = columns.shape[1]
    names = names or (["y"] if n == 1 else [f"y{o + 1}" for o in range(n)])
    if len(names) != n:
        raise Error(f"names must be {n}, one per column of outputs, got {len(names)}")
    if _order(order):
        places = _mixtures(model)
        if len(columns) % len(places):
            raise Error(f"outputs must be a multiple of {len(places)}, the samples of a row, got {len(columns)}")
        columns = columns.reshape(-1, len(places), n)[:, places, :].reshape(columns.shape)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(names)
    # repr is the shortest text of the same double; NaN is that of a failed run
    writer.writerows([repr(float(value)) for value in row] for row in columns)
    with tempfile.NamedTemporaryFile("w", suffix=".csv", encoding="utf-8") as file:
        file.write(text.getvalue())
        file.flush()
        return json.loads(_command(["indices", "-", file.name], _text(model)))


def table(result, name=None):
    """One dict for each line of a table of a result.

    Default: one for each cell, output and input of a result with indices, with every column of them.  Of a separation study
    without inputs: one for each cell, contact of a row and gap, with the probability of pounding.  name: another list that
    outputs have, such as "second_order", or of a separation study "pounding", "gaps", "rules", "fragility" or "return_periods",
    of a response of a row of buildings "modes".
    """
    rows = []
    if name in ("fragility", "return_periods"):
        for curves in result.get("fragility", []):
            contact = {"contact": curves["contact"]} if "contact" in curves else {}
            found = curves.get("curves" if name == "fragility" else name, [])
            rows += [{**curves["sweep"], **contact, **row} for row in found]
    else:
        for number, cell in enumerate(result.get("cells", [result])):
            where = {"cell": number, **cell.get("sweep", {})}
            outputs = cell.get("outputs") if name not in ("pounding", "gaps", "rules") else None
            if isinstance(outputs, list):
                for output in outputs:
                    rows += [{**where, "output": output["name"], **row} for row in output.get(name or "inputs", [])]
                continue
            for needs in cell.get("contacts", [cell]):
                contact = {"contact": needs["contact"]} if "contact" in needs else {}
                rows += [{**where, **contact, **row} for row in needs.get(name or "pounding", [])]
    if not rows:
        raise Error(f"a result of kind \"{result['kind']}\" has no table {name or 'of indices or gaps'} here")
    return rows


def salib(result, output, cell=0):
    """Indices of an output as SALib names them: a dict of arrays (inputs,), and S2 (inputs, inputs) if the design has it.

    NAME_conf is half the width of the 95 % interval, whose ends, not symmetric, are NAME_low and NAME_high.  A value that is
    null is NaN; S2 is there above the diagonal.
    """
    import numpy

    found = [one for one in result["cells"][cell]["outputs"] if one["name"] == output]
    if not found:
        names = ", ".join(one["name"] for one in result["cells"][cell]["outputs"])
        raise Error(f"no output {output!r} in cell {cell}; there are: {names}")
    inputs = found[0]["inputs"]
    names = [row["name"] for row in inputs]

    def with_width(indices, name):
        indices[f"{name}_conf"] = (indices[f"{name}_high"] - indices[f"{name}_low"]) / 2

    indices = {}
    for name in ("S1", "ST"):
        for column in (name, f"{name}_low", f"{name}_high"):
            indices[column] = numpy.array([row[column] for row in inputs], dtype=float)
        with_width(indices, name)
    pairs = found[0].get("second_order", [])
    if pairs:
        for column in ("S2", "S2_low", "S2_high"):
            indices[column] = numpy.full((len(names), len(names)), numpy.nan)
            for pair in pairs:
                place = tuple(sorted(names.index(name) for name in pair["inputs"]))
                indices[column][place] = numpy.nan if pair[column] is None else pair[column]
        with_width(indices, "S2")
    indices["names"] = names
    return indices
