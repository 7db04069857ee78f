/* client_python.c - the page client/python.md runs as one notebook, and pound.py gives the same results as `pound`. */
#include <string.h>
#include <unistd.h>

#include "tests/support/check.h"
#include "tests/support/program.h"
#include "tests/support/service.h"

static const char PYTHON[] = "/usr/bin/python3", PAGE[] = "client/python.md";

static struct program_outcome python(const char *script)
{
	return program_run((const char *const[]){PYTHON, "-", NULL}, script);
}

/* Sets the environment by which Python finds pound.py and pound; skips the test without Python and NumPy. */
static void prepare(void)
{
	const char *build = getenv("POUND_BUILD");
	char command[512];
	struct program_outcome there = python("import numpy\n");
	const int status = there.status;
	program_free(&there);
	if (status != 0)
		skip();
	char *folder = realpath(build ? build : "build/release", NULL);
	assert_non_null(folder);
	snprintf(command, sizeof command, "%s/pound", folder);
	setenv("POUND", command, 1);
	setenv("PYTHONPATH", "client", 1);
	setenv("PYTHONDONTWRITEBYTECODE", "1", 1);
	setenv("no_proxy", "127.0.0.1", 1);
	free(folder);
}

static void the_page_is_a_notebook_that_runs(void **state)
{
	size_t n;
	char *page = program_file(PAGE, NULL), *script = NULL;
	int blocks = 0;
	bool inside = false;
	(void)state;
	prepare();
	assert_non_null(page);
	FILE *out = open_memstream(&script, &n);
	for (char *line = strtok(page, "\n"); line; line = strtok(NULL, "\n")) {
		const bool begins = !strcmp(line, "```python"), ends = !strcmp(line, "```");
		blocks += begins;
		inside = begins || (inside && !ends);
		if (inside && !begins)
			fprintf(out, "%s\n", line);
	}
	fclose(out);
	assert_true(blocks >= 6);
	struct program_outcome outcome = python(script);
	program_expect(&outcome, 0);
	// printed: a line for each input, the problems of a study
	assert_non_null(strstr(outcome.out, "f_2: S1 0."));
	assert_non_null(strstr(outcome.out, "/scene/oscillators/0/frequency_hz: must be"));
	assert_non_null(strstr(outcome.out, "did you mean \"frequency_hz\"?"));
	check_report("%d cells of %s", blocks, PAGE);
	program_free(&outcome);
	free(script);
	free(page);
}

static void errors_of_command_and_server_name_every_fault(void **state)
{
	(void)state;
	prepare();
	struct program_outcome outcome = python(
	    "import os, pound\n"
	    "study = {'kind': 'response', 'scene': {'oscillators': [{'frequency_hz': 0}, {'frequency_hz': "
	    "-1}]}}\n"
	    "for url in (None, os.environ['POUND_URL']):\n"
	    "    try: pound.run(study, url=url)\n"
	    "    except pound.Error as error: text = str(error)\n"
	    "    assert 'oscillators/0/frequency_hz: must be' in text, text\n"
	    "    assert 'oscillators/1/frequency_hz: must be' in text, text\n"
	    "def fails(call, *words):\n"
	    "    try: call()\n"
	    "    except pound.Error as error: assert all(word in str(error) for word in words), str(error)\n"
	    "    else: assert False\n"
	    "model = {'inputs': [{'name': 'x', 'distribution': {'type': 'uniform', 'min': 0, 'max': 1}}], "
	    "'design': "
	    "{'rows': 40}}\n"
	    "X = pound.design(model)\n"
	    "assert X.shape == (120, 1)\n"
	    "fails(lambda: pound.indices(model, X[:-1]), 'has 119 lines', 'expected 120')\n"
	    "fails(lambda: pound.indices(model, X[:-1], order='salib'), 'multiple of 3')\n"
	    "fails(lambda: pound.indices(model, X, names=['a', 'b']), 'names must be 1')\n"
	    "fails(lambda: pound.design(model, order='sobol'), 'order must be')\n"
	    "fails(lambda: pound.salib(pound.indices(model, X), 'z'), 'there are: y')\n"
	    "fails(lambda: pound.run(study, url='http://127.0.0.1:1'), 'refused')\n"
	    "os.environ['POUND'] = '/nowhere/pound'\n"
	    "fails(lambda: pound.run(study), '/nowhere/pound')\n");
	program_expect(&outcome, 0);
	program_free(&outcome);
}

/* Rows of indices, and of gaps of a pair and of each contact of a row; other kinds of result are refused by name. */
static void a_table_has_the_rows_of_its_kind(void **state)
{
	(void)state;
	prepare();
	struct program_outcome outcome = python(
	    "import pound\n"
	    "pair = {'oscillators': [{'frequency_hz': 1}, {'frequency_hz': 1.7}], 'excitation': {'signals': 5}}\n"
	    "row = {'buildings': [{'storeys': 2, 'mass_kg': 1e5, 'frequency_hz': 1}, {'storeys': 2, 'mass_kg': "
	    "1e5, "
	    "'frequency_hz': 2}], 'excitation': {'signals': 5}}\n"
	    "study = {'kind': 'separation', 'scene': pair, 'separation': {'gaps_m': [0, 0.01, 1]}, 'sweep': "
	    "[{'path': "
	    "'/excitation/peak_m_s2', 'values': [1, 2]}]}\n"
	    "result = pound.run(study)\n"
	    "rows = pound.table(result)\n"
	    "assert [r['cell'] for r in rows] == [0, 0, 0, 1, 1, 1]\n"
	    "assert rows[3]['/excitation/peak_m_s2'] == 2 and rows[3]['probability'] == 1\n"
	    "assert [(r['gap_m'], r['probability']) for r in rows[:3]] == "
	    "[(p['gap_m'], p['probability']) for p in result['cells'][0]['pounding']]\n"
	    "assert len(pound.table(result, 'gaps')) == 12 and pound.table(result, 'rules')[4]['name'] == "
	    "'srss'\n"
	    "curves = pound.run({**study, 'separation': {'gaps_m': [0.01], 'intensity': "
	    "'/excitation/peak_m_s2'}})\n"
	    "assert pound.table(curves, 'fragility')[0]['gap_m'] == 0.01\n"
	    "result = pound.run({**study, 'scene': row})\n"
	    "rows = pound.table(result)\n"
	    "assert [r['contact'] for r in rows] == [0, 0, 0, 1, 1, 1] * 2\n"
	    "assert rows[4]['probability'] == result['cells'][0]['contacts'][1]['pounding'][1]['probability']\n"
	    "inputs = [{'path': '/oscillators/0/frequency_hz', 'distribution': {'type': 'uniform', 'min': 1, "
	    "'max': "
	    "2}}]\n"
	    "rows = pound.table(pound.run({**study, 'inputs': inputs, 'design': {'rows': 20}}))\n"
	    "assert len(rows) == 6 and 'S1' in rows[0] and rows[0]['output'] == 'gap_needed_m'\n"
	    "modes = pound.table(pound.run({'kind': 'response', 'scene': row}), 'modes')\n"
	    "assert [(m['building'], m['mode']) for m in modes] == [(0, 1), (0, 2), (1, 1), (1, 2)]\n"
	    "assert modes[2]['period_s'] == 0.5\n"
	    "try: pound.table(pound.run({'kind': 'response', 'scene': pair}))\n"
	    "except pound.Error as error: assert 'kind \"response\" has no table' in str(error), str(error)\n"
	    "else: assert False\n");
	program_expect(&outcome, 0);
	program_free(&outcome);
}

static void a_failed_run_and_a_variance_pass_to_the_indices_as_they_are(void **state)
{
	(void)state;
	prepare();
	struct program_outcome outcome = python(
	    "import json, math, numpy, pound, subprocess, os, tempfile\n"
	    "model = {'inputs': [{'name': n, 'distribution': {'type': 'normal', 'mean': 0, 'standard_deviation': "
	    "1}} for n in "
	    "'ab'], "
	    "'design': {'rows': 60, 'method': 'random'}}\n"
	    "X = pound.design(model)\n"
	    "Y = numpy.column_stack([X[:, 0] + X[:, 1] ** 3, numpy.full(len(X), 0.01), X[:, 0] / 3])\n"
	    "Y[7, 0] = math.nan\n"
	    "names = ['y', 'y.variance', 'z']\n"
	    "result = pound.indices(model, Y, names)\n"
	    "assert result['cells'][0]['rows_dropped'] == 1\n"
	    "with tempfile.NamedTemporaryFile('w') as file:\n"
	    "    file.write(','.join(names) + '\\n' + ''.join('%.17g,%.17g,%.17g\\n' % tuple(row) for row in "
	    "Y))\n"
	    "    file.flush()\n"
	    "    text = subprocess.run([os.environ['POUND'], 'indices', '-', file.name], "
	    "input=json.dumps(model), "
	    "capture_output=True, text=True, check=True).stdout\n"
	    "assert json.loads(text) == result\n"
	    "assert set(pound.salib(result, 'z')) == {a + b for a in ('S1', 'ST', 'S2') for b in ('', '_low', "
	    "'_high', "
	    "'_conf')} | {'names'}\n");
	program_expect(&outcome, 0);
	program_free(&outcome);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, program_setup, service_teardown)
CHECK_MAIN(TEST(the_page_is_a_notebook_that_runs), TEST(errors_of_command_and_server_name_every_fault),
           TEST(a_table_has_the_rows_of_its_kind),
           TEST(a_failed_run_and_a_variance_pass_to_the_indices_as_they_are))
