/* curve_plot.c - curves of one cell: `given`, `widths`; of a convergence study: `errors`. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "schema/figure/plot.h"

enum { OUTPUTS_MOST = 3, WIDTH_OUTPUTS_MOST = 6, PANEL_NARROWEST = 240, METHODS_MOST = 8, INPUTS_MOST = 16 };

/* ---- given ---- */

static bool has_curves(const cJSON *output)
{
	return cJSON_GetArraySize(plot_member(output, "conditional_means")) > 0;
}

bool plot_has_given(const cJSON *result)
{
	return plot_any_output(result, has_curves);
}

static double *places(struct plot *plot, const struct axis *axis, const cJSON *list, int *n)
{
	double *values = plot_numbers(plot, list, n);
	if (values)
		axis_places(axis, *n, values);
	return values;
}

static void range_list(struct range *range, const cJSON *list)
{
	const cJSON *value;
	cJSON_ArrayForEach(value, list) range_add(range, cJSON_IsNumber(value) ? value->valuedouble : NAN);
}

static void draw_curve_of(struct plot *plot, const cJSON *curve, const char *label, struct range range,
                          double mean, struct panel *panel)
{
	struct range across = RANGE_EMPTY;
	int n, n_low, n_high, n_mean;
	panel->bare = true;
	const cJSON *value;
	cJSON_ArrayForEach(value, plot_member(curve, "mean")) if (cJSON_IsNumber(value)) panel->bare = false;
	range_list(&across, plot_member(curve, "x"));
	panel->across = axis_linear(across);
	panel->up = axis_linear(range);
	panel->x_label = plot_text(curve, "name");
	panel->y_label = label;
	panel_draw(&plot->d, panel);
	double *x = places(plot, &panel->across, plot_member(curve, "x"), &n);
	double *y = places(plot, &panel->up, plot_member(curve, "mean"), &n_mean);
	double *low = places(plot, &panel->up, plot_member(curve, "low"), &n_low);
	double *high = places(plot, &panel->up, plot_member(curve, "high"), &n_high);
	double at = axis_at(&panel->up, mean);
	draw_line(&plot->d, &(struct pen){.ink = INK_MUTED, .dash = "4 3"}, panel->left, at, panel->right, at);
	if (!x || !y || !low || !high || n_mean != n || n_low != n || n_high != n)
		return;
	draw_band(&plot->d, &(struct pen){.ink = 0, .opacity = 0.2}, n, x, low, high);
	draw_curve(&plot->d, &(struct pen){.ink = 0, .width = 2}, n, x, y);
}

void plot_given(struct plot *plot)
{
	static const struct key keys[] = {
	    {.name = "mean given the input, with its 95 % band", .pen = {.ink = 0, .width = 2}, .band = true},
	    {.name = "mean over all samples", .pen = {.ink = INK_MUTED, .width = 1, .dash = "4 3"}}};
	char sweep[PLOT_TEXT], label[PLOT_TEXT], number[2][32], title[PLOT_TEXT + 40];
	const cJSON *cell = plot_cell(plot), *outputs[OUTPUTS_MOST], *curve;
	int n = cell ? plot_outputs(plot, cell, has_curves, OUTPUTS_MOST, outputs) : 0;
	if (n == 0)
		return;
	snprintf(title, sizeof title, "Mean output given one input");
	plot_head(plot, title, plot_sweep_text(cell, 0, NULL, sweep));
	double top = draw_legend(&plot->d, 2, keys, plot->y) + 8;
	for (int o = 0; o < n; o++) {
		const cJSON *curves = plot_member(outputs[o], "conditional_means");
		int index = 0, columns = panel_columns(&plot->d, cJSON_GetArraySize(curves), PANEL_NARROWEST);
		double mean = plot_number(outputs[o], "mean");
		struct range range = RANGE_EMPTY;
		range_add(&range, mean);
		cJSON_ArrayForEach(curve, curves)
		{
			range_list(&range, plot_member(curve, "mean"));
			range_list(&range, plot_member(curve, "low"));
			range_list(&range, plot_member(curve, "high"));
		}
		plot_output_name(outputs[o], label);
		cJSON_ArrayForEach(curve, curves)
		{
			struct panel panel = {.height = 230};
			panel_place(&plot->d, columns, index++, top, &panel);
			draw_curve_of(plot, curve, label, range, mean, &panel);
		}
		top = plot->d.height + 14;
		if (o == 0)
			snprintf(plot->sentence, sizeof plot->sentence,
			         "%.100s: mean %s; given one input, the mean lies in [%s, %s], bands included.", label,
			         draw_number(mean, title), draw_number(range.low, number[0]),
			         draw_number(range.high, number[1]));
	}
}

/* ---- widths ---- */

static bool has_widths(const cJSON *output)
{
	return cJSON_GetArraySize(plot_member(plot_member(output, "accuracy"), "rows")) > 1;
}

bool plot_has_widths(const cJSON *result)
{
	return plot_any_output(result, has_widths);
}

/* The cost of each number of rows: CPU seconds if the result has them for all, else the numbers of rows. */
static double *costs_of(struct plot *plot, const cJSON *rows, int *n, bool *cpu)
{
	const cJSON *timed = plot_member(plot_member(plot->result, "timing"), "rows"), *row;
	int n_timed, k = 0;
	double *numbers = plot_numbers(plot, rows, n), *seconds = plot_column(plot, timed, "cpu_s", &n_timed);
	*cpu = numbers && seconds && n_timed == *n;
	cJSON_ArrayForEach(row, timed)
	{
		*cpu = *cpu && k < *n && numbers[k] == plot_number(row, "rows") && seconds[k] > 0;
		k++;
	}
	return *cpu ? seconds : numbers;
}

static const struct pen GOAL = {
    .ink = INK_TEXT, .width = 1.2, .dash = "2 3"}; // half-width requested by the study

static void draw_widths(struct plot *plot, const cJSON *output, struct panel *panel)
{
	static const char *const members[] = {"S1_half_widths", "ST_half_widths"};
	const cJSON *accuracy = plot_member(output, "accuracy"), *input;
	int n, j = 0;
	bool cpu;
	char title[PLOT_TEXT], text[PLOT_TEXT], number[2][32];
	double *cost = costs_of(plot, plot_member(accuracy, "rows"), &n, &cpu);
	double goal = plot_number(plot_member(plot->result, "stopping"), "half_width");
	struct range across = RANGE_EMPTY, up = RANGE_EMPTY;
	double *x = plot_memory(plot, 3 * sizeof *x * (size_t)(n + 1));
	if (!cost || !x)
		return;
	double *y = x + n + 1, *widest = y + n + 1;
	for (int k = 0; k < n; k++) {
		range_add(&across, cost[k]);
		widest[k] = NAN;
	}
	cJSON_ArrayForEach(input, plot_member(accuracy, "inputs")) for (int i = 0; i < 2; i++)
	{
		const cJSON *width;
		cJSON_ArrayForEach(width, plot_member(input, members[i])) if (width->valuedouble > 0)
		    range_add(&up, width->valuedouble);
	}
	panel->bare = up.low > up.high;
	if (goal > 0)
		range_add(&up, goal);
	panel->title = plot_output_name(output, title);
	panel->x_label = cpu ? "CPU time [s]" : "rows";
	panel->y_label = "half width";
	panel->across = axis_log(across);
	panel->up = axis_log(up);
	panel_draw(&plot->d, panel);
	for (int k = 0; k < n; k++)
		x[k] = axis_at(&panel->across, cost[k]);
	cJSON_ArrayForEach(input, plot_member(accuracy, "inputs"))
	{
		for (int i = 0; i < 2; i++) {
			int n_widths;
			double *width = plot_numbers(plot, plot_member(input, members[i]), &n_widths);
			if (!width || n_widths != n)
				continue;
			for (int k = 0; k < n; k++) {
				widest[k] = fmax(widest[k], width[k]);
				y[k] = axis_at(&panel->up, width[k]);
			}
			draw_curve(&plot->d,
			           &(struct pen){.ink = (enum ink)(j % DRAW_SERIES),
			                         .width = 1.2,
			                         .dash = i ? NULL : "6 3",
			                         .opacity = 0.85},
			           n, x, y);
			for (int k = 0; k < n; k++) {
				snprintf(text, sizeof text, "%.100s: half width of %.2s %s at %s %s",
				         plot_text(input, "name"), members[i], draw_number(width[k], number[0]),
				         draw_number(cost[k], number[1]), cpu ? "s" : "rows");
				draw_mark(&plot->d, &(struct mark){.series = j, .hollow = i == 0, .size = 3}, x[k], y[k],
				          text);
			}
		}
		j++;
	}
	axis_places(&panel->up, n, widest);
	draw_curve(&plot->d, &(struct pen){.ink = INK_TEXT, .width = 2.6, .opacity = 0.55}, n, x, widest);
	double at = axis_at(&panel->up, goal);
	draw_line(&plot->d, &GOAL, panel->left, at, panel->right, at);
}

void plot_widths(struct plot *plot)
{
	char sweep[PLOT_TEXT], number[32], asked[64];
	const double goal = plot_number(plot_member(plot->result, "stopping"), "half_width");
	struct key keys[INPUTS_MOST + 4];
	const cJSON *cell = plot_cell(plot), *outputs[WIDTH_OUTPUTS_MOST], *input;
	int n = cell ? plot_outputs(plot, cell, has_widths, WIDTH_OUTPUTS_MOST, outputs) : 0, n_keys = 0, j = 0;
	if (n == 0)
		return;
	plot_head(plot, "Half-widths of the 95 % intervals over CPU time or rows",
	          plot_sweep_text(cell, 0, NULL, sweep));
	keys[n_keys++] = (struct key){.name = "widest", .pen = {.ink = INK_TEXT, .width = 2.6, .opacity = 0.55}};
	keys[n_keys++] =
	    (struct key){.name = "S1: hollow, dashed", .pen = {.ink = INK_MUTED, .width = 1.2, .dash = "6 3"}};
	keys[n_keys++] = (struct key){.name = "ST: filled", .pen = {.ink = INK_MUTED, .width = 1.2}};
	if (isfinite(goal)) {
		snprintf(asked, sizeof asked, "requested: %s", draw_number(goal, number));
		keys[n_keys++] = (struct key){.name = asked, .pen = GOAL};
	}
	cJSON_ArrayForEach(input, plot_member(outputs[0], "inputs"))
	{
		if (j == INPUTS_MOST)
			break;
		keys[n_keys++] =
		    (struct key){.name = plot_text(input, "name"), .mark = {.series = j++}, .marked = true};
	}
	double top = draw_legend(&plot->d, n_keys, keys, plot->y) + 8;
	int columns = panel_columns(&plot->d, n, 300);
	for (int o = 0; o < n; o++) {
		struct panel panel = {.height = 300};
		panel_place(&plot->d, columns, o, top, &panel);
		draw_widths(plot, outputs[o], &panel);
	}
	snprintf(plot->sentence, sizeof plot->sentence, "%.0f rows: the widest 95 %% interval of %.80s is +-%s.",
	         plot_number(plot_member(plot->result, "design"), "rows"), plot_text(outputs[0], "name"),
	         draw_number(plot_number(plot_member(plot_member(outputs[0], "accuracy"), "errors"), "sampling"),
	                     number));
}

/* ---- errors ---- */

bool plot_has_errors(const cJSON *result)
{
	return cJSON_GetArraySize(plot_member(result, "rows")) > 0;
}

/* The numbers of each row of a convergence study, and memory for positions. */
struct points {
	const double *cpu, *error; /* of all rows */
	double *x, *y, *setting;
};

/* The step or the tolerance of a row. */
static double setting_of(const cJSON *row)
{
	const double step = plot_number(row, "step_s");
	return isfinite(step) ? step : plot_number(row, "tolerance");
}

static const char *method_text(const cJSON *row, double error, double cpu, char text[PLOT_TEXT])
{
	char number[3][32];
	snprintf(text, PLOT_TEXT, "%.60s, %s %s: error %s, %s s", plot_text(row, "method"),
	         isfinite(plot_number(row, "step_s")) ? "step" : "tolerance",
	         draw_number(setting_of(row), number[0]), draw_number(error, number[1]),
	         draw_number(cpu, number[2]));
	return text;
}

/* Draws the rows of a method in descending order of step or tolerance, as measured times of single runs may be out of order. */
static void draw_method(struct plot *plot, const struct panel *panel, const struct key *key,
                        const char *method, int series, const struct points *points)
{
	const cJSON *row;
	char text[PLOT_TEXT];
	int at = 0, k = -1;
	cJSON_ArrayForEach(row, plot_member(plot->result, "rows"))
	{
		k++;
		if (strcmp(method, plot_text(row, "method")) != 0)
			continue;
		int place = at++;
		const double setting = setting_of(row);
		for (; place > 0 && points->setting[place - 1] < setting; place--) {
			points->x[place] = points->x[place - 1];
			points->y[place] = points->y[place - 1];
			points->setting[place] = points->setting[place - 1];
		}
		points->setting[place] = setting;
		points->x[place] = axis_at(&panel->across, points->cpu[k]);
		points->y[place] = axis_at(&panel->up, points->error[k]);
		if (key->marked)
			draw_mark(&plot->d, &(struct mark){.series = series}, points->x[place], points->y[place],
			          method_text(row, points->error[k], points->cpu[k], text));
	}
	if (key->marked)
		draw_curve(&plot->d, &key->pen, at, points->x, points->y);
	else if (at > 0)
		draw_line(&plot->d, &key->pen, points->x[0], panel->top, points->x[0], panel->bottom);
}

void plot_errors(struct plot *plot)
{
	const char *quantity = plot->choice->quantity ? plot->choice->quantity : "displacement";
	const char *methods[METHODS_MOST] = {0};
	const cJSON *rows = plot_member(plot->result, "rows"), *row;
	struct key keys[METHODS_MOST + 1];
	struct range across = RANGE_EMPTY, up = RANGE_EMPTY;
	char name[64], title[PLOT_TEXT], number[3][32];
	int n, n_cpu, n_methods = 0, k = 0;
	snprintf(name, sizeof name, "%s_error_mean", quantity);
	double *error = plot_column(plot, rows, name, &n);
	double *timed = plot_numbers(plot, plot_member(plot_member(plot->result, "timing"), "run_cpu_s"), &n_cpu);
	double *cpu = plot_memory(plot, sizeof *cpu * (size_t)(n + 1));
	double *x = plot_memory(plot, 3 * sizeof *x * (size_t)(n + 1));
	if (!error || !timed || !cpu || !x)
		return;
	for (int r = 0; r < n; r++)
		cpu[r] = r < n_cpu ? timed[r] : NAN;
	snprintf(title, sizeof title, "Error of each solver against its CPU time: %s", quantity);
	plot_head(plot, title, "relative to the event solver, means over the signals");
	cJSON_ArrayForEach(row, rows)
	{
		const char *method = plot_text(row, "method");
		int m = 0;
		while (m < n_methods && strcmp(methods[m], method) != 0)
			m++;
		if (m == n_methods && n_methods < METHODS_MOST)
			methods[n_methods++] = method;
		if (cpu[k] > 0)
			range_add(&across, cpu[k]);
		if (error[k] > 0)
			range_add(&up, error[k]);
		k++;
	}
	for (int m = 0; m < n_methods; m++) {
		bool event = strcmp(methods[m], "event") == 0;
		keys[m] = key_of_series(methods[m], m);
		if (event)
			keys[m] = (struct key){.name = "event: exact, only its time is drawn",
			                       .pen = {.ink = INK_TEXT, .width = 1.8, .dash = "5 4"}};
	}
	double top = draw_legend(&plot->d, n_methods, keys, plot->y) + 6;
	struct panel panel = {.height = 420,
	                      .x_label = "CPU time of one run [s]",
	                      .y_label = "relative error",
	                      .bare = across.low > across.high || up.low > up.high,
	                      .across = axis_log(across),
	                      .up = axis_log(up)};
	panel_place(&plot->d, 1, 0, top, &panel);
	panel_draw(&plot->d, &panel);
	for (int m = 0; m < n_methods; m++)
		draw_method(plot, &panel, &keys[m], methods[m], m,
		            &(struct points){cpu, error, x, x + n + 1, x + 2 * (n + 1)});
	snprintf(plot->sentence, sizeof plot->sentence,
	         "The event solver takes %s s of CPU time; errors from %s to %s.", draw_number(cpu[0], number[0]),
	         draw_number(up.low, number[1]), draw_number(up.high, number[2]));
}
