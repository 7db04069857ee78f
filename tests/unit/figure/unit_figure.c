/* unit_figure.c - figures of results: well-formed SVG within the view box, the same bytes each time, safe against
 * hostile names; ticks of any range. */
#include <ctype.h>
#include <math.h>
#include <string.h>

#include "schema/examples/examples.h"
#include "schema/figure/draw.h"
#include "schema/figure/figure.h"
#include "schema/json/json_pointer.h"
#include "schema/result/result_json.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/program.h"
#include "tests/support/scenes.h"
#include "tests/support/study_documents.h"

enum { SVG_MOST = 300000, DEPTH_MOST = 16 };

/* ---- ticks ---- */

static void ticks_of_any_range_are_few_and_inside(void **state)
{
	static const struct range ranges[] = {
	    {0, 1},           {-0.2, 1.3},
	    {1e-300, 1e-300}, {0, 0},
	    {5, 5},           {-7, -7},
	    {1e-300, 3e-300}, {-1.7e308, 1.7e308},
	    {0, 1.7e308},     {0, 5e-324},
	    {1, 1 + 1e-15},   {999999, 1000001},
	    {1e-320, 1},      {INFINITY, -INFINITY},
	    {0.1, 100},       {1e-14, 1e-1},
	    {3, 4},           {1e6, 1e6 + 0.001},
	};
	(void)state;
	for (size_t i = 0; i < sizeof ranges / sizeof ranges[0]; i++)
		for (int log = 0; log < 2; log++) {
			struct ticks ticks;
			struct axis axis = log ? axis_log(ranges[i]) : axis_linear(ranges[i]);
			double last = -1;
			axis.start = 0, axis.end = 500;
			axis_ticks(&axis, 8, &ticks);
			if (ticks.n < 1 || ticks.n > 9 + 2 * log)
				fail_msg("range %zu, log %d: %d ticks", i, log, ticks.n);
			for (int k = 0; k < ticks.n; k++) {
				double at = axis_at(&axis, ticks.tick[k].value);
				if (!(at > last) || at > 500.6 || at < -0.6 || !*ticks.tick[k].text)
					fail_msg("range %zu, log %d: tick %d '%s' at %g behind %g", i, log, k, ticks.tick[k].text,
					         at, last);
				last = at;
			}
			// every value has a position between the ends
			for (int end = 0; end < 2; end++) {
				double value = end ? ranges[i].high : ranges[i].low, at = axis_at(&axis, value);
				if (ranges[i].low <= ranges[i].high && (!log || value > 0) && !(at >= -0.6 && at <= 500.6))
					fail_msg("range %zu, log %d: %g is at %g", i, log, value, at);
			}
		}
}

static void the_text_of_a_tick_has_the_digits_it_needs(void **state)
{
	struct ticks ticks;
	(void)state;
	struct axis axis = axis_linear((struct range){0, 0.5});
	axis_ticks(&axis, 5, &ticks);
	assert_int_equal(ticks.n, 6);
	assert_string_equal(ticks.tick[3].text, "0.3");
	axis = axis_linear((struct range){-2e-9, 2e-9});
	axis_ticks(&axis, 5, &ticks);
	assert_int_equal(ticks.exponent, -9);
	assert_string_equal(ticks.tick[0].text, "−2");
	axis = axis_log((struct range){2e-7, 0.3});
	axis_ticks(&axis, 9, &ticks);
	assert_string_equal(ticks.tick[0].text, "10⁻⁶");
}

/* ---- XML ---- */

/* Fails unless the text is XML of elements, attributes, entities and text, without duplicate attributes, scripts,
 * links, ids or characters that XML forbids; every coordinate of a path must be in the view box. */
static void check_svg(const char *what, const char *svg, size_t length)
{
	char open[DEPTH_MOST][32];
	double width, height;
	int depth = 0;
	if (length != strlen(svg) || length > SVG_MOST)
		fail_msg("%s: %zu bytes", what, length);
	const char *box = strstr(svg, "viewBox=\"0 0 ");
	assert_true(box && sscanf(box, "viewBox=\"0 0 %lf %lf\"", &width, &height) == 2);
	for (const char *c = svg; *c; c++) {
		if ((unsigned char)*c < 0x20 && *c != '\n')
			fail_msg("%s: control character %d", what, *c);
		if (*c == '&' && strncmp(c, "&amp;", 5) && strncmp(c, "&lt;", 4) && strncmp(c, "&gt;", 4) &&
		    strncmp(c, "&quot;", 6) && strncmp(c, "&#39;", 5))
			fail_msg("%s: entity %.20s", what, c);
		if (*c != '<')
			continue;
		bool closes = c[1] == '/';
		const char *name = c + 1 + closes, *end = strchr(c, '>');
		size_t n = strcspn(name, " />");
		assert_non_null(end);
		if (n == 0 || n > 30 || memchr(c + 1, '<', (size_t)(end - c - 1)))
			fail_msg("%s: tag %.40s", what, c);
		if (closes) {
			if (depth == 0 || strncmp(open[--depth], name, n) != 0 || open[depth][n])
				fail_msg("%s: %.40s closes '%s'", what, c, open[depth]);
		} else if (end[-1] != '/') {
			assert_true(depth < DEPTH_MOST);
			snprintf(open[depth++], sizeof open[0], "%.*s", (int)n, name);
		}
		char tag[64];
		snprintf(tag, sizeof tag, " %.*s ", (int)n, name);
		if (!strstr(" svg title desc style rect path circle text ", tag))
			fail_msg("%s: element %s", what, tag);
		int quotes = 0;
		for (const char *a = c; a < end; a++)
			quotes += *a == '"';
		if (quotes % 2)
			fail_msg("%s: quotes of %.60s", what, c);
		const char *d = strstr(c, " d=\"");
		if (d && d < end)
			for (d += 4; *d != '"';) {
				char command = *d, *after;
				if (isupper((unsigned char)command))
					d++;
				double first = strtod(d, &after), second = first;
				d = after + (*after == ' ');
				if (command == 'M' || command == 'L')
					second = strtod(d, &after);
				bool across = command != 'V', up = command != 'H';
				if (command != 'Z' && ((across && (first < -1 || first > width + 1)) ||
				                       (up && (second < -1 || second > height + 1))))
					fail_msg("%s: %c%g %g is not in %g x %g", what, command, first, second, width, height);
				if (command == 'Z' || after == d)
					d = command == 'Z' ? d : after;
				else if (command == 'M' || command == 'L')
					d = after;
			}
	}
	if (depth != 0)
		fail_msg("%s: '%s' is open", what, open[depth - 1]);
	if (strstr(svg, "<script") || strstr(svg, "href") || strstr(svg, " id=") || strstr(svg, " style="))
		fail_msg("%s: script, link, id or style", what);
	if (!strstr(svg, "role=\"img\"") || strstr(svg, "<title></title>") || strstr(svg, "<desc></desc>"))
		fail_msg("%s: no role, title or sentence", what);
}

static struct figure drawn(const char *name, const struct figure_source *source,
                           const struct figure_choice *choice)
{
	struct figure figure;
	enum figure_status status = figure_draw(name, source, choice, &figure);
	if (status != FIGURE_DRAWN)
		fail_msg("%s: %d %s", name, (int)status, figure.detail);
	return figure;
}

/* Draws all figures of a result, narrow and wide; returns their number. */
static int draw_all(const char *what, const struct figure_source *source)
{
	static const char *const widths[] = {"320", "1120", "1400"};
	int n = 0;
	for (const struct figure_row *row = figure_rows; row->name; row++) {
		if (!figure_has(row, source) || (row->sampled && !source->samples))
			continue;
		for (int k = 0; k < 3; k++) {
			char name[160];
			struct figure figure = drawn(row->name, source, &(struct figure_choice){.width = widths[k]});
			snprintf(name, sizeof name, "%s of %s at %s", row->name, what, widths[k]);
			check_svg(name, figure.svg, figure.length);
			free(figure.svg);
		}
		n++;
	}
	return n;
}

/* ---- results ---- */

/* The result of a study document, and its histories if it has any. */
static struct figure_source result_of(const char *document)
{
	struct figure_source source = {0};
	const struct timing timing = {1, 1, 1};
	struct pound_study *study = study_documents_study(document);
	struct pound_run *run = specimen_run(study);
	source.json = result_to_json(study, pound_run_result(run), &timing, &source.length);
	if (histories_exist(study))
		source.samples = histories_to_csv(study, run, -1, &source.n_samples, &(const char *){NULL});
	pound_run_free(run);
	study_free(study);
	assert_non_null(source.json);
	return source;
}

static void source_free(struct figure_source *source)
{
	free((char *)source->json);
	free((char *)source->samples);
}

/* A copy with every number that has a decimal point or an exponent replaced. */
static char *with_numbers(const char *json, const char *number, size_t *length)
{
	size_t n = strlen(json), at = 0;
	char *copy = malloc(n * 4 + 1);
	bool inside = false;
	assert_non_null(copy);
	for (const char *c = json; *c;) {
		size_t digits = inside ? 0 : strspn(c, "-+.eE0123456789");
		if (digits > 0 && (isdigit((unsigned char)*c) || *c == '-') && strcspn(c, ".eE") < digits) {
			at += (size_t)sprintf(copy + at, "%s", number);
			c += digits;
			continue;
		}
		if (*c == '"' && (c == json || c[-1] != '\\'))
			inside = !inside;
		copy[at++] = *c++;
	}
	copy[at] = '\0';
	*length = at;
	return copy;
}

static bool is_quick(const char *name)
{
	return strncmp(name, "paper", 5) != 0 && strcmp(name, "design") != 0 && strcmp(name, "extremes") != 0;
}

static void every_figure_of_every_example_is_well_formed_and_within_its_view_box(void **state)
{
	// also equal, missing, tiny and huge numbers
	static const char *const numbers[] = {"null", "0", "1e-300", "-1e-300", "1.7e308", "0.25"};
	int n = 0, n_numbers = 0;
	(void)state;
	for (int i = 0; example_name(i); i++) {
		if (!is_quick(example_name(i)))
			continue;
		struct figure_source source = result_of(example_text(example_name(i)));
		n += draw_all(example_name(i), &source);
		for (size_t k = 0; k < sizeof numbers / sizeof numbers[0]; k++) {
			char what[120];
			struct figure_source other = {.samples = source.samples, .n_samples = source.n_samples};
			char *json = with_numbers(source.json, numbers[k], &other.length);
			other.json = json;
			snprintf(what, sizeof what, "%s with %s", example_name(i), numbers[k]);
			n_numbers += draw_all(what, &other);
			free(json);
		}
		source_free(&source);
	}
	assert_true(n >= 20 && n_numbers >= 100);
}

static void a_figure_has_a_mark_for_each_index(void **state)
{
	struct figure_source source = result_of(example_text("sensitivity_small"));
	struct figure figure = drawn("indices", &source, &(struct figure_choice){0});
	int marks = 0;
	(void)state;
	for (const char *c = figure.svg; (c = strstr(c, "<title>")); c++)
		marks++;
	// two outputs, four inputs, S1 and ST; and the title of the figure
	assert_int_equal(marks, 2 * 4 * 2 + 1);
	free(figure.svg);
	source_free(&source);
}

static void a_name_stays_text(void **state)
{
	static const char hostile[] = "</text><script>alert(1)</script>&\\\"'\\u0007\\u202e\\ufffe";
	// the reader of studies refuses some of these; a result may come from elsewhere
	struct figure_source asked = result_of(example_text("sensitivity_small")), source = {0};
	source.json = study_documents_with(asked.json, "f_2", hostile);
	source.length = strlen(source.json);
	(void)state;
	draw_all("a hostile name", &source);
	struct figure figure = drawn("indices", &source, &(struct figure_choice){0});
	assert_non_null(strstr(figure.svg,
	                       "&lt;/text&gt;&lt;script&gt;alert(1)&lt;/script&gt;&amp;&quot;&#39;\xEF\xBF\xBD"
	                       "\xEF\xBF\xBD\xEF\xBF\xBD: ST"));
	free(figure.svg);
	source_free(&source);
	source_free(&asked);
}

static void a_long_name_keeps_its_beginning_and_its_end(void **state)
{
	struct drawing d;
	size_t n;
	(void)state;
	draw_init(&d, 320);
	draw_text(&d, &(struct label){.x = 10, .y = 20, .fit = 120},
	          "the stiffness of the contact of building 11");
	draw_text(&d, &(struct label){.x = 10, .y = 40, .fit = 60}, "ααααααααααααααααααααααααω");
	draw_text(&d, &(struct label){.x = 10, .y = 60, .fit = 190}, "drift amplification, building 11, story 4");
	char *svg = draw_take(&d, "title", "sentence", &n);
	// its title is the whole name
	const char *text = strstr(svg, "<title>the stiffness of the contact of building 11</title>the s");
	assert_non_null(text);
	assert_non_null(strstr(text, "…"));
	assert_non_null(strstr(text, "ng 11</text>"));
	assert_non_null(strstr(text, "αω</text>"));
	assert_non_null(strstr(text, "</title>drift"));
	assert_non_null(strstr(text, "…, building 11, story 4</text>"));
	check_svg("a long name", svg, n);
	free(svg);
}

static void a_curve_shows_points_without_neighbors(void **state)
{
	static const double x[] = {10, 20, 30, 40, 50}, y[] = {10, NAN, 15, NAN, 20};
	struct drawing d;
	size_t n;
	(void)state;
	draw_init(&d, 320);
	draw_curve(&d, &(struct pen){.width = 2}, 5, x, y);
	char *svg = draw_take(&d, "title", "sentence", &n);
	assert_non_null(strstr(svg, "stroke-linecap=\"round\""));
	assert_non_null(strstr(svg, "M10 10L10 10M30 15L30 15M50 20L50 20"));
	free(svg);
}

static void a_short_logarithmic_axis_has_two_ticks_at_least(void **state)
{
	static const struct range ranges[] = {{0.03, 0.2}, {2, 3}, {1e-300, 4e-300}, {1e-250, 1e250}};
	(void)state;
	for (size_t i = 0; i < sizeof ranges / sizeof ranges[0]; i++)
		for (int most = 2; most < 8; most++) {
			struct ticks ticks;
			struct axis axis = axis_log(ranges[i]);
			axis.start = 0, axis.end = 200;
			axis_ticks(&axis, most, &ticks);
			if (ticks.n < 2)
				fail_msg("range %zu, at most %d: %d ticks", i, most, ticks.n);
		}
}

static void what_has_no_value_says_so(void **state)
{
	// results in which only the counts have values
	static const char *const names[] = {"sensitivity_small", "floor_spectrum", "response", "street", "until"};
	(void)state;
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
		struct figure_source source = result_of(example_text(names[i])), none = {0};
		char *json = with_numbers(source.json, "null", &none.length);
		none.json = json;
		for (const struct figure_row *row = figure_rows; row->name; row++) {
			if (row->sampled || strcmp(row->name, "pairs") == 0 || !figure_has(row, &none))
				continue;
			struct figure figure = drawn(row->name, &none, &(struct figure_choice){0});
			if (!strstr(figure.svg, ">no value<"))
				fail_msg("%s of %s is an empty frame", row->name, names[i]);
			free(figure.svg);
		}
		free(json);
		source_free(&source);
	}
}

static void a_force_is_drawn_for_each_contact(void **state)
{
	static const char samples[] = "signal,time_s,contact_force_n,gap_m\r\n"
	                              "0,0,0,0.1\r\n0,1,0,0\r\n0,1,2,0\r\n0,2,5,-0.2\r\n0,3,-1,0\r\n0,3,0,0\r\n"
	                              "0,4,0,0.3\r\n0,5,0,0\r\n0,6,3,-0.1\r\n0,7,0,0\r\n1,7,9,-9\r\n";
	const struct figure_source source = {
	    .json = "{}", .length = 2, .samples = samples, .n_samples = sizeof samples - 1};
	(void)state;
	struct figure figure = drawn("force", &source, &(struct figure_choice){0});
	assert_non_null(
	    strstr(figure.svg, "<desc>2 contacts; the largest force is 5 N, the largest overlap 0.2 m.</desc>"));
	int curves = 0;
	for (const char *c = figure.svg; (c = strstr(c, "fill=\"none\"")); c++)
		curves++;
	assert_int_equal(curves, 2);
	free(figure.svg);
	figure = drawn("force", &source, &(struct figure_choice){.to = "0.5"});
	assert_non_null(strstr(figure.svg, "no value"));
	free(figure.svg);
}

static void a_contact_in_time_has_a_mark_in_its_cell_alone(void **state)
{
	static const char samples[] =
	    "signal,time_s,duration_s,cell,contact,left_building,left_level,right_level,approach_speed_m_s,"
	    "impulse_n_s\r\n"
	    "0,0.5,0.1,0,0,0,1,1,0.3,20\r\n0,1,0,0,1,0,2,1.5,0.2,80\r\n0,2,0,0,2,1,2,2,0.2,5\r\n"
	    "0,3,0,1,0,,,,0.2,7\r\n1,4,0,0,0,0,1,1,1,900\r\n";
	const struct figure_source source = {
	    .json = "{}", .length = 2, .samples = samples, .n_samples = sizeof samples - 1};
	(void)state;
	struct figure figure = drawn("timeline", &source, &(struct figure_choice){0});
	assert_non_null(strstr(
	    figure.svg, "<desc>3 contacts; the largest impulse, 80 N s, begins at 1 s at level 2.</desc>"));
	assert_non_null(strstr(figure.svg, "1 s, level 2: impulse 80 N s, approach 0.2 m/s, 0 s long"));
	assert_non_null(strstr(figure.svg, ">buildings 1 and 2<"));
	assert_null(strstr(figure.svg, "900"));
	free(figure.svg);
	figure = drawn("timeline", &source, &(struct figure_choice){.cell = "1"});
	assert_non_null(
	    strstr(figure.svg, "<desc>1 contacts; the largest impulse, 7 N s, begins at 3 s.</desc>"));
	free(figure.svg);
	figure = drawn("timeline", &source, &(struct figure_choice){.signal = "7"});
	assert_non_null(strstr(figure.svg, "<desc>No contact.</desc>"));
	free(figure.svg);
}

static void panels_of_a_sweep_say_what_all_of_them_share(void **state)
{
	char *document = study_documents_with(
	    example_text("gap"), "\"sweep\": [",
	    "\"sweep\": [{\"path\": \"/oscillators/0/mass_kg\", \"values\": [1, 2]},"
	    " {\"path\": \"/contact/restitution\", \"values\": [0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9]}, ");
	struct figure_source source = result_of(document);
	struct figure figure = drawn("responses", &source, &(struct figure_choice){0});
	(void)state;
	// eight panels, those of the first mass
	assert_non_null(strstr(figure.svg, "; means over the signals; left mass 1 kg<"));
	assert_non_null(strstr(figure.svg, ">restitution 0.2<"));
	assert_non_null(strstr(figure.svg, "Shown: 8 of 16 combinations"));
	free(figure.svg);
	source_free(&source);
	free(document);
}

static void buildings_stand_on_one_scale_of_height_in_metres(void **state)
{
	struct figure_source source = {0};
	(void)state;
	source.json = program_file("tests/cases/figures/heights.json", &source.length);
	struct figure figure = drawn("heights", &source, &(struct figure_choice){0});
	assert_non_null(figure.svg);
	// 18 m and 24 m high: every panel goes up to 24 m
	int labels = 0, ticks = 0;
	for (const char *at = figure.svg; (at = strstr(at, ">height [m]<")); at++)
		labels++;
	for (const char *at = figure.svg; (at = strstr(at, ">15<")); at++)
		ticks++;
	assert_int_equal(labels, 4);
	assert_int_equal(ticks, 4);
	assert_null(strstr(figure.svg, ">story<"));
	assert_non_null(strstr(figure.svg, "story 5, with pounding: "));
	assert_non_null(strstr(figure.svg, "floor 8, without pounding: "));
	free(figure.svg);
	source_free(&source);
}

static void a_line_does_not_end_between_a_number_and_its_unit(void **state)
{
	static const struct {
		const char *text, *first;
	} cases[] = {{"gap 0 m, right mass 1 kg", ">gap 0 m, right mass<"},
	             {"gap 0 m, right mass 10\u2076 kg", ">gap 0 m, right mass<"},
	             {"mass 123456789012345 kilogram", ">mass<"},
	             {"123456789012345 kilogram", ">123456789012345<"}};
	(void)state;
	for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
		struct drawing d;
		size_t n;
		draw_init(&d, 400);
		draw_prose(&d, &(struct label){.y = 20, .fit = draw_width(cases[k].text, DRAW_TEXT_SIZE) - 8},
		           cases[k].text, 2);
		char *svg = draw_take(&d, "title", "sentence", &n);
		assert_non_null(svg);
		if (!strstr(svg, cases[k].first))
			fail_msg("no '%s' in %s", cases[k].first, svg);
		free(svg);
	}
}

static void the_golden_figures_have_not_changed(void **state)
{
	// pound plot NAME tests/cases/figures/SOURCE >tests/cases/figures/NAME.svg, then look at it
	static const struct {
		const char *name, *source;
	} golden[] = {{"indices", "indices.json"},       {"swept", "swept.json"},
	              {"given", "given.json"},           {"widths", "given.json"},
	              {"pairs", "given.json"},           {"spectra", "spectra.json"},
	              {"responses", "responses.json"},   {"history", "history.csv"},
	              {"errors", "errors.json"},         {"heights", "heights.json"},
	              {"impacts", "heights.json"},       {"force", "history.csv"},
	              {"separation", "separation.json"}, {"fragility", "separation.json"},
	              {"timeline", "timeline.csv"},      {"suite", "suite.csv"}};
	enum { GOLDEN = sizeof golden / sizeof golden[0] };
	(void)state;
	assert_null(figure_rows[GOLDEN].name); // every figure has one
	for (int i = 0; i < GOLDEN; i++) {
		char path[64];
		size_t n;
		struct figure_source source = {0};
		const bool sampled = figure_row(golden[i].name)->sampled;
		snprintf(path, sizeof path, "tests/cases/figures/%s", golden[i].source);
		char *bytes = program_file(path, sampled ? &source.n_samples : &source.length);
		if (sampled)
			source = (struct figure_source){
			    .json = strdup("{}"), .length = 2, .samples = bytes, .n_samples = source.n_samples};
		else
			source.json = bytes;
		snprintf(path, sizeof path, "tests/cases/figures/%s.svg", golden[i].name);
		char *known = program_file(path, &n);
		struct figure figure = drawn(golden[i].name, &source, &(struct figure_choice){0});
		if (figure.length != n || memcmp(figure.svg, known, n) != 0)
			fail_msg("%s differs", path);
		free(figure.svg);
		free(known);
		source_free(&source);
	}
}

static void what_is_no_figure_is_refused_with_a_reason(void **state)
{
	struct figure_source source = result_of(example_text("response")), none = {.json = "[1]", .length = 3};
	static const struct {
		const char *name;
		struct figure_choice choice;
		enum figure_status status;
		const char *detail;
	} cases[] = {
	    {"nothing", {0}, FIGURE_UNKNOWN, "no figure is called \"nothing\""},
	    {"heigth", {0}, FIGURE_UNKNOWN, "no figure is called \"heigth\", did you mean \"heights\"?"},
	    {"indices", {0}, FIGURE_ABSENT, "kind \"sensitivity\", not \"response\"; it has: responses"},
	    {"history", {0}, FIGURE_ABSENT, "no figure \"history\""},
	    {"heights", {0}, FIGURE_ABSENT, "it shows a row of buildings; it has: responses"},
	    {"impacts", {0}, FIGURE_ABSENT, "a row of buildings with contacts; it has: responses"},
	    {"suite", {0}, FIGURE_ABSENT, "a table of its own (pound motion --periods)"},
	    {"responses", {.width = "319"}, FIGURE_CHOICE, "width must be a whole number in [320, 2400]"},
	    {"responses", {.width = "-400"}, FIGURE_CHOICE, "width must be"},
	    {"responses", {.width = "400x"}, FIGURE_CHOICE, "width must be"},
	    {"responses", {.width = "99999999999999999999"}, FIGURE_CHOICE, "width must be"},
	    {"responses", {.axis = "hz"}, FIGURE_CHOICE, "takes no argument \"axis\""},
	    {"responses", {.x = "/scene"}, FIGURE_CHOICE, "x must be the path"},
	};
	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct figure figure;
		enum figure_status status = figure_draw(cases[i].name, &source, &cases[i].choice, &figure);
		if (status != cases[i].status || !strstr(figure.detail, cases[i].detail) || figure.svg)
			fail_msg("%s: %d %s", cases[i].name, (int)status, figure.detail);
	}
	struct figure figure;
	assert_int_equal(figure_draw("indices", &none, &(struct figure_choice){0}, &figure), FIGURE_RESULT);
	none = (struct figure_source){.json = "{", .length = 1};
	assert_int_equal(figure_draw("indices", &none, &(struct figure_choice){0}, &figure), FIGURE_RESULT);
	source_free(&source);
	source = result_of(example_text("sensitivity_small"));
	const struct figure_choice wrong[] = {
	    {.output = "no"}, {.cell = "1"}, {.index = "S2"}, {.output = ""}, {.cell = ""}};
	for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
		assert_int_equal(figure_draw("indices", &source, &wrong[i], &figure), FIGURE_CHOICE);
	source_free(&source);
}

static void a_result_lists_the_figures_that_it_has(void **state)
{
	size_t n;
	struct figure_source source = result_of(example_text("sensitivity_small"));
	char *list = figure_list(&source, "/v1/studies/00", &n);
	struct reading *reading = reading_open(list, n);
	(void)state;
	assert_int_equal(reading_count(reading, "/figures"), 1);
	assert_string_equal(reading_text(reading, "/figures/0/name"), "indices");
	assert_string_equal(reading_text(reading, "/figures/0/link"), "/v1/studies/00/figures/indices");
	assert_string_equal(reading_text(reading, "/figures/0/arguments/1"), "output");
	reading_close(reading);
	free(list);
	source_free(&source);
}

static void every_figure_and_argument_stands_in_the_docs(void **state)
{
	char line[400], *page = program_file("schema/figure/figures.md", NULL);
	static const struct {
		const char *name, *text;
	} arguments[] = {
#define X(name, values, lowest, highest, text) {#name, text},
	    FIGURE_ARGUMENTS(X)
#undef X
	};
	(void)state;
	assert_non_null(page);
	for (const struct figure_row *row = figure_rows; row->name; row++) {
		int n = snprintf(line, sizeof line, "| `%s` | %s | %s |", row->name, row->kind, row->text);
		char takes[120];
		snprintf(takes, sizeof takes, "%s", row->takes);
		for (char *rest, *name = strtok_r(takes, " ", &rest), *comma = ""; name;
		     name = strtok_r(NULL, " ", &rest), comma = ",")
			n += snprintf(line + n, sizeof line - (size_t)n, "%s `%s`", comma, name);
		snprintf(line + n, sizeof line - (size_t)n, " |\n");
		if (!strstr(page, line))
			fail_msg("schema/figure/figures.md has no line\n%s", line);
	}
	for (size_t k = 0; k < sizeof arguments / sizeof arguments[0]; k++) {
		snprintf(line, sizeof line, "| `%s` | %s |\n", arguments[k].name, arguments[k].text);
		if (!strstr(page, line))
			fail_msg("schema/figure/figures.md has no line\n%s", line);
	}
	free(page);
}

/* If a result lacks what a figure needs, the message uses the terms of study documents. */
static void a_figure_that_a_result_has_not_says_what_it_needs(void **state)
{
	static const struct {
		const char *example, *figure, *detail;
	} cases[] = {
	    {"unequal_heights", "responses",
	     "it shows two oscillators, not a row of buildings; it has: heights, impacts"},
	    {"sensitivity_small", "swept", "it needs a \"sweep\" over a number; it has: indices"},
	    {"sensitivity_small", "given", "it needs 30 rows"},
	    {"sensitivity_small", "widths", "it needs 60 rows"},
	    {"sensitivity_small", "pairs", "\"order\": \"second\""},
	    {"floor_spectrum", "history", "the samples of a study with \"histories\": true"},
	    {"response", "timeline",
	     "it is drawn from the samples (pound run --samples FILE); it has: responses"},
	    {"suite", "fragility", "kind \"separation\", not \"response\""},
	};
	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct figure figure;
		struct figure_source source = result_of(example_text(cases[i].example)), alone = source;
		alone.samples = NULL;
		assert_int_equal(figure_draw(cases[i].figure, &alone, &(struct figure_choice){0}, &figure),
		                 FIGURE_ABSENT);
		if (!strstr(figure.detail, cases[i].detail))
			fail_msg("%s of %s: %s", cases[i].figure, cases[i].example, figure.detail);
		source_free(&source);
	}
}

#define CONSTANT                                                                                             \
	"{\"name\": \"constant\", \"inputs\": [{\"name\": \"a\"}, {\"name\": \"b\"}], \"accuracy\": {\"rows\": " \
	"[60]}}, "

/* Whatever the first outputs are, a figure is drawn from the outputs that have its numbers. */
static void a_constant_output_hides_no_figure(void **state)
{
	static const char json[] =
	    "{\"kind\": \"sensitivity\", \"engine_version\": \"1\", \"cells\": [{\"outputs\": "
	    "[" CONSTANT CONSTANT CONSTANT CONSTANT CONSTANT CONSTANT
	    "{\"name\": \"impulse\", \"mean\": 1, \"inputs\": [{\"name\": \"a\", \"S1\": 0.5}, {\"name\": \"b\", "
	    "\"S1\": 0.5}], \"second_order\": [{\"inputs\": [\"a\", \"b\"], \"S2\": 0.5}], "
	    "\"conditional_means\": [{\"name\": \"a\", \"x\": [1, 2], \"mean\": [1, 2], \"low\": [1, 2], "
	    "\"high\": [1, 2]}], \"accuracy\": {\"rows\": [30, 60], \"inputs\": [{\"name\": \"a\", "
	    "\"S1_half_widths\": [0.5, 0.25], \"ST_half_widths\": [0.5, 0.25]}]}}]}]}";
	static const char *const names[] = {"given", "pairs", "widths"};
	const struct figure_source source = {.json = json, .length = sizeof json - 1};
	(void)state;
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
		struct figure figure = drawn(names[i], &source, &(struct figure_choice){0});
		assert_non_null(strstr(figure.svg, "impulse"));
		assert_null(strstr(figure.svg, "constant"));
		free(figure.svg);
		assert_int_equal(
		    figure_draw(names[i], &source, &(struct figure_choice){.output = "constant"}, &figure),
		    FIGURE_CHOICE);
		assert_string_equal(figure.detail, "output \"constant\" has no numbers for this figure in this cell");
	}
}

CHECK_MAIN(cmocka_unit_test(a_figure_that_a_result_has_not_says_what_it_needs),
           cmocka_unit_test(a_constant_output_hides_no_figure),
           cmocka_unit_test(ticks_of_any_range_are_few_and_inside),
           cmocka_unit_test(the_text_of_a_tick_has_the_digits_it_needs),
           cmocka_unit_test(every_figure_of_every_example_is_well_formed_and_within_its_view_box),
           cmocka_unit_test(a_figure_has_a_mark_for_each_index), cmocka_unit_test(a_name_stays_text),
           cmocka_unit_test(a_long_name_keeps_its_beginning_and_its_end),
           cmocka_unit_test(a_curve_shows_points_without_neighbors),
           cmocka_unit_test(a_short_logarithmic_axis_has_two_ticks_at_least),
           cmocka_unit_test(what_has_no_value_says_so), cmocka_unit_test(a_force_is_drawn_for_each_contact),
           cmocka_unit_test(a_contact_in_time_has_a_mark_in_its_cell_alone),
           cmocka_unit_test(panels_of_a_sweep_say_what_all_of_them_share),
           cmocka_unit_test(buildings_stand_on_one_scale_of_height_in_metres),
           cmocka_unit_test(a_line_does_not_end_between_a_number_and_its_unit),
           cmocka_unit_test(the_golden_figures_have_not_changed),
           cmocka_unit_test(what_is_no_figure_is_refused_with_a_reason),
           cmocka_unit_test(a_result_lists_the_figures_that_it_has),
           cmocka_unit_test(every_figure_and_argument_stands_in_the_docs))
