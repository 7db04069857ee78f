/* unit_result_csv.c - results as tables. */
#include <string.h>

#include "schema/result_json.h"
#include "tests/check.h"

static void becomes(const char *json, const char *wanted)
{
	size_t length;
	char *csv = result_to_csv(json, strlen(json), &length);
	assert_non_null(csv);
	assert_string_equal(csv, wanted);
	assert_int_equal(length, strlen(wanted));
	free(csv);
}

static void a_row_for_every_cell_output_and_input(void **state)
{
	(void)state;
	becomes("{\"kind\": \"sensitivity\", \"cells\": [{\"sweep\": {\"/law/type\": \"linear\", "
	        "\"/contact/gap_m\": 0.1}, \"runs\": 3,"
	        "\"outputs\": [{\"name\": \"impulse\", \"mean\": 1.5, \"variance\": 0.25, \"noise_share\": null, "
	        "\"note\": \"why\","
	        "\"inputs\": [{\"name\": \"f_e\", \"path\": \"/a\", \"S1\": 0.30000000000000004, \"ST\": 1},"
	        "{\"name\": \"=1,2\", \"path\": \"/b\", \"S1\": null, \"ST\": -1e-300}]}]},"
	        "{\"sweep\": {\"/law/type\": \"elastoplastic\", \"/contact/gap_m\": 0.2}, \"outputs\": "
	        "[{\"name\": \"impulse\","
	        "\"mean\": 2, \"variance\": 3, \"noise_share\": 4, \"inputs\": [{\"name\": \"f_e\", \"path\": "
	        "\"/a\", \"S1\": 5, \"ST\": 6}]}]}]}",
	        "/law/type,/contact/"
	        "gap_m,output.name,output.mean,output.variance,output.noise_share,name,path,S1,ST\r\n"
	        "linear,0.1,impulse,1.5,0.25,,f_e,/a,0.30000000000000004,1\r\n"
	        "linear,0.1,impulse,1.5,0.25,,\"'=1,2\",/b,,-1e-300\r\n"
	        "elastoplastic,0.2,impulse,2,3,4,f_e,/a,5,6\r\n");
}

static void error_estimates_stand_by_their_output_and_input(void **state)
{
	(void)state;
	becomes(
	    "{\"cells\": [{\"sweep\": {}, \"outputs\": [{\"name\": \"impulse\", \"inputs\": [{\"name\": \"a\"}, "
	    "{\"name\": \"b\"}], \"accuracy\": {\"slope\": -0.5, \"rows\": [1, 2], \"inputs\": "
	    "[{\"S1_integration\": 1}, {\"S1_integration\": 2}], \"errors\": {\"sampling\": 3}}}]}]}",
	    "output.name,output.accuracy.slope,name,accuracy.S1_integration\r\n"
	    "impulse,-0.5,a,1\r\nimpulse,-0.5,b,2\r\n");
}

static void shares_of_the_excitation_stand_by_their_output(void **state)
{
	(void)state;
	becomes("{\"cells\": [{\"sweep\": {}, \"outputs\": [{\"name\": \"impulse\", \"excitation\": "
	        "{\"ST_one_signal\": 0.5}, \"inputs\": [{\"name\": \"a\", \"S1\": 1, \"S1_raw\": 2, "
	        "\"note\": \"words\"}]}]}]}",
	        "output.name,output.excitation.ST_one_signal,name,S1,S1_raw\r\nimpulse,0.5,a,1,2\r\n");
}

static void a_row_for_every_cell_and_signal(void **state)
{
	(void)state;
	static const char signal[] =
	    "{\"index\": 0, \"oscillators\": [{\"demand\": 1, \"force_max_n\": 2}, {\"demand\": null, "
	    "\"force_max_n\": 4}], \"impulse_max_n_s\": 5, \"end\": {\"u1_m\": 6}}";
	char json[1024];
	snprintf(json, sizeof json, "{\"kind\": \"response\", \"signals\": [%s, %s], \"outputs\": {}}", signal,
	         signal);
	becomes(json, "index,impulse_max_n_s,oscillator_1.demand,oscillator_1.force_max_n,oscillator_2.demand,"
	              "oscillator_2.force_max_n,end.u1_m\r\n0,5,1,2,,4,6\r\n0,5,1,2,,4,6\r\n");
	snprintf(
	    json, sizeof json,
	    "{\"kind\": \"response\", \"cells\": [{\"sweep\": {\"/contact/tension\": true}, \"signals\": [%s]}]}",
	    signal);
	becomes(json, "/contact/tension,index,impulse_max_n_s,oscillator_1.demand,oscillator_1.force_max_n,"
	              "oscillator_2.demand,oscillator_2.force_max_n,end.u1_m\r\ntrue,0,5,1,2,,4,6\r\n");
}

static void what_is_no_result_gives_no_table(void **state)
{
	(void)state;
	size_t length;
	assert_null(result_to_csv("{", 1, &length));
	becomes("{}", "");
	becomes("{\"cells\": []}", "");
}

CHECK_MAIN(cmocka_unit_test(a_row_for_every_cell_output_and_input),
           cmocka_unit_test(error_estimates_stand_by_their_output_and_input),
           cmocka_unit_test(shares_of_the_excitation_stand_by_their_output),
           cmocka_unit_test(a_row_for_every_cell_and_signal),
           cmocka_unit_test(what_is_no_result_gives_no_table))
