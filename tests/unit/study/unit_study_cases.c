/* unit_study_cases.c - problems that the reader reports for study documents, case by case: tests/cases/study_*.txt.
 *
 * A file is read line by line; a blank line ends a paragraph, # begins a comment.
 *
 *   base NAME            the base text for the following cases: a document of tests/support/study_documents.h
 *   /design/rows         the field that this paragraph tests: its pattern in fields.c
 *   - TEXT               the first occurrence of TEXT in the base (a line break and following spaces count as one space) ...
 *   = TEXT               ... is replaced by this TEXT in every following case of the paragraph
 *   + TEXT               a case: replaced by this TEXT, the study is valid
 *   ! TEXT               a case: replaced by this TEXT, the study has these problems and no others:
 *       POINTER: DETAIL    {PATTERN} is replaced by the values that the field accepts, so a new row of a table changes no case
 *
 * In a paragraph without -, TEXT is the whole document. */
#include <ctype.h>
#include <string.h>

#include "schema/study/fields.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/program.h"
#include "tests/support/study_documents.h"

struct study_case {
	const char *file;
	int line;              /* line of the case */
	const char *field;     /* pattern of the tested field; "" if the case tests none */
	const char *document;  /* the whole document */
	int n;                 /* number of expected problems; 0: the study is valid */
	const char **expected; /* (n) "POINTER: DETAIL" */
};

enum { EXPECTED_MAX = 40 };

struct cases {
	const char *file;
	int line;
	char *base;            /* the current base; heap */
	char *changed;         /* base with the replacements of this paragraph; heap, NULL: none yet */
	const char *field;     /* field of the paragraph */
	const char *from;      /* NULL: the next text is a whole document */
	struct study_case now; /* the current case; document NULL: none */
	const char *expected[EXPECTED_MAX];
	void (*show)(const struct study_case *of, void *context);
	void *context;
	int n;
};

/* A copy of a document in which a line break and the spaces after it are one space. */
static char *one_line(const char *document)
{
	char *copy = strdup(document), *to = copy;
	assert_non_null(copy);
	for (const char *at = document; *at; at++) {
		*to++ = *at == '\n' ? ' ' : *at;
		if (*at == '\n')
			at += strspn(at + 1, " ");
	}
	*to = 0;
	return copy;
}

/* Passes the current case, if there is one, to the function: all its expected problems have been read. */
static void finish(struct cases *cases)
{
	if (!cases->now.document)
		return;
	cases->show(&cases->now, cases->context);
	free((char *)cases->now.document);
	cases->now.document = NULL;
	cases->n++;
}

static char *replaced(const struct cases *cases, const char *text)
{
	const char *document = cases->changed ? cases->changed : cases->base;
	if (!cases->from)
		return strdup(text);
	if (!document || !strstr(document, cases->from))
		fail_msg("%s:%d: the base has no %s", cases->file, cases->line, cases->from);
	return study_documents_with(document, cases->from, text);
}

static void paragraph_end(struct cases *cases)
{
	finish(cases);
	free(cases->changed);
	cases->changed = NULL;
	cases->field = "";
	cases->from = NULL;
}

/* Reads a line that is neither blank nor a comment. */
static void line_take(struct cases *cases, const char *line)
{
	const char *text = line + 2;
	if (strncmp(line, "    ", 4) == 0) {
		if (!cases->now.document || cases->now.n == EXPECTED_MAX)
			fail_msg("%s:%d: a problem of no case", cases->file, cases->line);
		cases->expected[cases->now.n++] = line + 4;
		return;
	}
	finish(cases);
	if (strncmp(line, "base ", 5) == 0) {
		free(cases->base);
		cases->base = one_line(documents_named(line + 5));
	} else if (*line == '/') {
		cases->field = line;
	} else if (*line == '-' && line[1] == ' ') {
		cases->from = text;
	} else if (*line == '=' && line[1] == ' ') {
		char *changed = replaced(cases, text);
		free(cases->changed);
		cases->changed = changed;
		cases->from = NULL;
	} else if ((*line == '+' || *line == '!') && (line[1] == ' ' || !line[1])) {
		cases->now = (struct study_case){.file = cases->file,
		                                 .line = cases->line,
		                                 .field = cases->field,
		                                 .document = replaced(cases, line[1] ? text : ""),
		                                 .expected = cases->expected};
	} else {
		fail_msg("%s:%d: what is %s", cases->file, cases->line, line);
	}
}

/* Reads all cases of a file, passes each to a function and returns their number.  A malformed line fails the test. */
static int study_cases(const char *file, void (*show)(const struct study_case *of, void *context),
                       void *context)
{
	struct cases cases = {.file = file, .field = "", .show = show, .context = context};
	size_t length;
	char *text = program_file(file, &length);
	if (!text)
		fail_msg("no file %s", file);
	for (char *line = text, *next; line; line = next) {
		next = strchr(line, '\n');
		if (next)
			*next++ = 0;
		cases.line++;
		if (!*line)
			paragraph_end(&cases);
		else if (*line != '#')
			line_take(&cases, line);
	}
	paragraph_end(&cases);
	free(cases.base);
	free(text);
	return cases.n;
}

static const char *const files[] = {"tests/cases/study_fields.txt", "tests/cases/study_rules.txt"};
enum {
	N_FILES = sizeof files / sizeof files[0],
	FIELDS_MAX = 200,
	LINE_SIZE = sizeof(((struct problem *)0)->pointer) + sizeof(((struct problem *)0)->detail) + 4,
};

/* "POINTER: DETAIL", as files of cases have it. */
static void line_of(const struct problem *problem, char line[LINE_SIZE])
{
	snprintf(line, LINE_SIZE, "%s: %s", problem->pointer, problem->detail);
}

/* An expected problem, with patterns in braces replaced by the values that the fields accept. */
static void filled(const char *expected, char line[LINE_SIZE])
{
	const char *open = strchr(expected, '{'), *close = open ? strchr(open, '}') : NULL;
	char pattern[120], takes[FIELDS_EXPECTED_SIZE];
	if (!close || open[1] != '/') {
		snprintf(line, LINE_SIZE, "%s", expected);
		return;
	}
	snprintf(pattern, sizeof pattern, "%.*s", (int)(close - open - 1), open + 1);
	const struct field *field = fields_find(pattern);
	if (!field)
		fail_msg("no field %s", pattern);
	fields_expected(field, takes, sizeof takes);
	snprintf(line, LINE_SIZE, "%.*s%s%s", (int)(open - expected), expected, takes, close + 1);
}

static int n_wrong; // number of cases that failed

/* Files named by documents are in tests/cases/records. */
static char *record_file(const void *with, const struct study_source *of, size_t *length,
                         char why[STUDY_WHY_SIZE])
{
	const char *name = of->file ? of->file : of->sha256;
	char path[256];
	(void)with;
	snprintf(path, sizeof path, "tests/cases/records/%s", name);
	snprintf(why, STUDY_WHY_SIZE, "cannot be read: no such file");
	return program_file(path, length);
}

static void judge(const struct study_case *of, void *context)
{
	static struct problems problems;
	static const struct study_files records = {.read = record_file};
	const struct study_document document = {
	    .text = of->document, .length = strlen(of->document), .files = &records};
	struct pound_study *study = study_from_document(&document, &problems);
	bool as_expected = problems.n == of->n && !problems.n_more && !study == (of->n > 0);
	char line[LINE_SIZE], want[LINE_SIZE];
	(void)context;
	for (int i = 0; i < problems.n && i < of->n; i++) {
		line_of(&problems.list[i], line);
		filled(of->expected[i], want);
		as_expected &= strcmp(line, want) == 0;
	}
	if (study)
		study_free(study);
	if (as_expected)
		return;
	n_wrong++;
	print_error("%s:%d:\n", of->file, of->line);
	for (int i = 0; i < problems.n; i++) {
		line_of(&problems.list[i], line);
		print_error("    got    %s\n", line);
	}
	for (int i = 0; i < of->n; i++) {
		filled(of->expected[i], want);
		print_error("    wanted %s\n", want);
	}
}

static void a_document_is_valid_or_has_the_problems_of_its_case(void **state)
{
	int n = 0;
	(void)state;
	n_wrong = 0;
	for (int f = 0; f < N_FILES; f++)
		n += study_cases(files[f], judge, NULL);
	check_report("%d cases", n);
	assert_true(n > 300);
	assert_int_equal(n_wrong, 0);
}

struct covered {
	bool valid[FIELDS_MAX], invalid[FIELDS_MAX];
};

/* Whether a problem is about the field, one of its members or elements, or an object or array that contains it. */
static bool about(const char *pattern, const char *problem)
{
	for (; *pattern && *problem != ':'; pattern++, problem++) {
		if (*pattern == '*' && isdigit((unsigned char)*problem))
			problem += strspn(problem, "0123456789") - 1;
		else if (*pattern != *problem)
			return false;
	}
	return (!*pattern || *pattern == '/') && (*problem == ':' || *problem == '/');
}

static void cover(const struct study_case *of, void *context)
{
	struct covered *covered = context;
	const struct field *field = *of->field ? fields_find(of->field) : NULL;
	bool own = false;
	if (*of->field && !field)
		fail_msg("%s:%d: no field has the pattern %s", of->file, of->line, of->field);
	if (!field)
		return;
	for (int i = 0; i < of->n; i++)
		own |= about(of->field, of->expected[i]);
	covered->valid[field - fields] |= of->n == 0;
	covered->invalid[field - fields] |= own;
}

/* Whether a member of a row's contact is a member of the scene's contact from the same line of fields.c. */
static bool of_contact(const struct field *field)
{
	char pattern[128];
	snprintf(pattern, sizeof pattern, "/scene/contact/%s", fields_name(field));
	return strncmp(field->pattern, "/scene/contacts/*/", strlen("/scene/contacts/*/")) == 0 &&
	       fields_find(pattern);
}

static void every_field_has_a_valid_and_an_invalid_case(void **state)
{
	struct covered covered = {{0}, {0}};
	int n_missing = 0;
	(void)state;
	assert_true(fields_count <= FIELDS_MAX);
	for (int f = 0; f < N_FILES; f++)
		study_cases(files[f], cover, &covered);
	for (int i = 0; i < fields_count; i++) {
		if (of_contact(&fields[i]))
			continue;
		if (!covered.valid[i])
			print_error("%s has no valid case\n", fields[i].pattern);
		if (!covered.invalid[i])
			print_error("%s has no invalid case\n", fields[i].pattern);
		n_missing += !covered.valid[i] + !covered.invalid[i];
	}
	assert_int_equal(n_missing, 0);
}

CHECK_MAIN(cmocka_unit_test(a_document_is_valid_or_has_the_problems_of_its_case),
           cmocka_unit_test(every_field_has_a_valid_and_an_invalid_case))
