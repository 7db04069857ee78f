/* unit_result_csv.c - results as tables. */
#include <string.h>

#include "schema/result/result_json.h"
#include "tests/support/check.h"

static void tabulates(const char *json, const char *table, const char *wanted)
{
	size_t length;
	char *csv = result_to_csv(json, strlen(json), table, &length);
	assert_non_null(csv);
	assert_string_equal(csv, wanted);
	assert_int_equal(length, strlen(wanted));
	free(csv);
}

static void becomes(const char *json, const char *wanted)
{
	tabulates(json, NULL, wanted);
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
	assert_null(result_to_csv("{", 1, NULL, &length));
	becomes("{}", "");
	becomes("{\"cells\": []}", "");
}

/* one cell of two outputs; the second has only one index */
#define CELL(lists)                                                                                       \
	"\"cells\": [{\"sweep\": {\"/contact/gap_m\": 0.1}, \"outputs\": [{\"name\": \"impulse\", \"mean\": " \
	"1, " lists "}, {\"name\": \"other\", \"inputs\": [{\"name\": \"a\", \"S1\": 1}]}]}]"

static void lists_of_sets_have_a_column_for_each_member_of_the_largest(void **state)
{
	(void)state;
	static const char json[] = "{" CELL(
	    "\"inputs\": [{\"name\": \"a\", \"S1\": 1}], \"second_order\": [{\"inputs\": [\"a\", \"b\"], "
	    "\"S2\": 0.5, \"S2_low\": 0.25, \"S2_high\": 1}], \"closed\": [{\"inputs\": [\"a\"], "
	    "\"S_closed\": 2}, {\"inputs\": [\"a\", \"b\", \"c,d\"], \"S_closed\": null}]") "}";
	tabulates(json, "second_order",
	          "/contact/gap_m,output.name,input_1,input_2,S2,S2_low,S2_high\r\n"
	          "0.1,impulse,a,b,0.5,0.25,1\r\n");
	tabulates(json, "closed",
	          "/contact/gap_m,output.name,input_1,input_2,input_3,S_closed\r\n"
	          "0.1,impulse,a,,,2\r\n0.1,impulse,a,b,\"c,d\",\r\n");
	tabulates(json, "inputs",
	          "/contact/gap_m,output.name,output.mean,name,S1\r\n0.1,impulse,1,a,1\r\n0.1,other,,a,1\r\n");
}

static void ratios_and_curves_are_tables_of_their_own(void **state)
{
	(void)state;
	static const char json[] = "{" CELL(
	    "\"ratios\": {\"explained\": 0.75, \"variables\": [{\"name\": \"a/b\", \"shapley\": 1, \"S1\": 2}]}, "
	    "\"conditional_means\": [{\"name\": \"a\", \"path\": \"/a\", \"x\": [1, 2], \"mean\": [3, 4], "
	    "\"low\": [5, null], \"high\": [7, 8]}]") "}";
	tabulates(json, "ratios",
	          "/contact/gap_m,output.name,explained,name,shapley,S1\r\n0.1,impulse,0.75,a/b,1,2\r\n");
	tabulates(json, "conditional_means",
	          "/contact/gap_m,output.name,name,path,x,mean,low,high\r\n"
	          "0.1,impulse,a,/a,1,3,5,7\r\n0.1,impulse,a,/a,2,4,,8\r\n");
}

static void every_look_of_a_design_that_grew_is_a_row_whatever_it_found(void **state)
{
	(void)state;
	tabulates(
	    "{" CELL(
	        "\"inputs\": []") ", \"stopping\": {\"half_width\": 0.1, \"max_runs\": 90, \"reached\": true, "
	                          "\"looks\": [{\"rows\": 1, \"runs\": 5, \"half_width\": null}, {\"rows\": 2, "
	                          "\"runs\": 10, \"half_width\": "
	                          "0.05, \"index\": \"ST\", \"input\": \"a\", \"output\": \"impulse\", "
	                          "\"sweep\": {\"/contact/gap_m\": "
	                          "0.1}}]}}",
	    "stopping",
	    "rows,runs,half_width,index,input,output,/contact/gap_m,asked.half_width,asked.max_runs,reached\r\n"
	    "1,5,,,,,,0.1,90,true\r\n2,10,0.05,ST,a,impulse,0.1,0.1,90,true\r\n");
}

static void every_row_of_a_partial_result_says_of_how_many_rows_it_is(void **state)
{
	(void)state;
	static const char json[] = "{\"partial\": {\"rows\": 30, \"rows_most\": 90, \"note\": \"so far\"}, " CELL(
	    "\"inputs\": [{\"name\": \"a\", \"S1\": 1}], \"closed\": [{\"inputs\": [\"a\"], \"S_closed\": "
	    "2}]") "}";
	tabulates(json, "closed",
	          "partial.rows,partial.rows_most,/contact/gap_m,output.name,input_1,S_closed\r\n"
	          "30,90,0.1,impulse,a,2\r\n");
	becomes(json, "partial.rows,partial.rows_most,/contact/gap_m,output.name,output.mean,name,S1\r\n"
	              "30,90,0.1,impulse,1,a,1\r\n30,90,0.1,other,,a,1\r\n");
}

static void a_table_that_a_result_has_not_is_empty(void **state)
{
	(void)state;
	static const char *const tables[] = {"second_order", "closed",   "ratios", "conditional_means",
	                                     "stopping",     "nonsense", ""};
	for (int k = 0; k < 7; k++)
		tabulates("{" CELL("\"inputs\": []") "}", tables[k], "");
}

/* gaps of a cell or contact */
#define NEEDS(gap)                                                                                      \
	"\"gap_needed\": {\"runs\": 2, \"mean_m\": " gap ", \"signals_m\": [" gap ", 0.5]}, \"pounding\": " \
	"[{\"gap_m\": 0, \"probability\": 1}], \"gaps\": [{\"probability\": 0.5, \"gap_m\": " gap           \
	", \"note\": \"why\"}], \"correlation\": 0.25, \"rules\": [{\"name\": \"srss\", \"gap_m\": 3}]"

static void every_list_of_a_study_of_separation_is_a_table(void **state)
{
	(void)state;
	static const char pair[] =
	    "{\"kind\": \"separation\", \"suite\": {\"records\": [{\"index\": 0, \"factor\": 2}, {\"index\": 1, "
	    "\"name\": \"b\", \"factor\": 3}]}, \"cells\": [{\"sweep\": {\"/contact/gap_m\": 0.1}, \"runs\": "
	    "2, " NEEDS(
	        "0.75") ", \"outputs\": {\"impulse\": 1.5, \"force_amplification\": null}}], \"fragility\": "
	                "[{\"intensity\": \"/x\", \"sweep\": {}, \"curves\": [{\"gap_m\": 0.25, \"median\": 2}], "
	                "\"return_periods\": [{\"return_period_years\": 475, \"gap_m\": 4}]}]}";
	becomes(pair, "/contact/gap_m,gap_m,probability\r\n0.1,0,1\r\n");
	tabulates(pair, "pounding", "/contact/gap_m,gap_m,probability\r\n0.1,0,1\r\n");
	tabulates(pair, "gaps", "/contact/gap_m,probability,gap_m\r\n0.1,0.5,0.75\r\n");
	tabulates(pair, "rules", "/contact/gap_m,name,gap_m\r\n0.1,srss,3\r\n");
	tabulates(pair, "gap_needed",
	          "/contact/gap_m,runs,correlation,gap_needed.runs,gap_needed.mean_m\r\n0.1,2,0.25,2,0.75\r\n");
	tabulates(pair, "signals", "/contact/gap_m,index,gap_needed_m\r\n0.1,0,0.75\r\n0.1,1,0.5\r\n");
	tabulates(pair, "outputs",
	          "/contact/gap_m,output.name,output.mean\r\n0.1,impulse,1.5\r\n0.1,force_amplification,\r\n");
	tabulates(pair, "fragility", "intensity,gap_m,median\r\n/x,0.25,2\r\n");
	tabulates(pair, "return_periods", "intensity,return_period_years,gap_m\r\n/x,475,4\r\n");
	tabulates(pair, "records", "name,index,factor\r\n,0,2\r\nb,1,3\r\n");
}

static void modes_of_buildings_are_a_table(void **state)
{
	(void)state;
	static const char result[] = "{\"kind\": \"response\", \"cells\": [{\"sweep\": {\"/x\": 1}, \"modes\": "
	                             "[{\"building\": 0, \"mode\": 1, "
	                             "\"period_s\": 0.5}, {\"building\": 1, \"mode\": 1, \"period_s\": 0.25}], "
	                             "\"signals\": [{\"index\": 0}]}]}";
	tabulates(result, "modes", "/x,building,mode,period_s\r\n1,0,1,0.5\r\n1,1,1,0.25\r\n");
	becomes(result, "/x,index\r\n1,0\r\n");
}

static void each_contact_of_a_row_has_lines_of_its_own(void **state)
{
	(void)state;
	static const char row[] = "{\"cells\": [{\"sweep\": {}, \"contacts\": [{\"contact\": 0, " NEEDS(
	    "0.75") "}, {\"contact\": 1, " NEEDS("0.875") "}]}], \"fragility\": [{\"contact\": 1, \"intensity\": "
	                                                  "\"/x\", \"sweep\": {\"/a\": 1}, \"curves\": "
	                                                  "[{\"gap_m\": "
	                                                  "0.25}]}]}";
	becomes(row, "contact,gap_m,probability\r\n0,0,1\r\n1,0,1\r\n");
	tabulates(row, "gaps", "contact,probability,gap_m\r\n0,0.5,0.75\r\n1,0.5,0.875\r\n");
	tabulates(row, "gap_needed",
	          "contact,correlation,gap_needed.runs,gap_needed.mean_m\r\n0,0.25,2,0.75\r\n1,0.25,2,0.875\r\n");
	tabulates(row, "signals",
	          "contact,index,gap_needed_m\r\n0,0,0.75\r\n0,1,0.5\r\n1,0,0.875\r\n1,1,0.5\r\n");
	tabulates(row, "fragility", "/a,contact,intensity,gap_m\r\n1,1,/x,0.25\r\n");
}

static void stories_and_contacts_of_a_row_are_lines(void **state)
{
	(void)state;
	static const char json[] =
	    "{\"kind\": \"response\", \"signals\": [{\"index\": 3, \"buildings\": [{\"storeys\": "
	    "[{\"drift_max_m\": 1}, "
	    "{\"drift_max_m\": 2}], \"floors\": [{\"acceleration_max_m_s2\": 5, \"end\": {\"u_m\": 7}}, "
	    "{\"acceleration_max_m_s2\": 6, \"end\": {\"u_m\": 8}}]}, {\"storeys\": [{\"drift_max_m\": 4}], "
	    "\"floors\": []}], \"contacts\": [{\"left_building\": 0, \"levels\": [1, 1.5], \"contact_count\": "
	    "9}]}]}";
	tabulates(json, "storeys",
	          "signal,building,storey,drift_max_m,acceleration_max_m_s2,end.u_m\r\n"
	          "3,0,1,1,5,7\r\n3,0,2,2,6,8\r\n3,1,1,4,,\r\n");
	tabulates(json, "contacts",
	          "signal,contact,left_level,right_level,left_building,contact_count\r\n3,0,1,1.5,0,9\r\n");
}

static void a_line_that_lacks_a_column_leaves_it_empty(void **state)
{
	(void)state;
	static const char json[] =
	    "{\"cells\": [{\"outputs\": [{\"name\": \"peak_drift_m\", \"building\": 0, \"storey\": 1, \"mean\": "
	    "2, "
	    "\"inputs\": [{\"S1\": 3}]}, {\"name\": \"gap_needed_m\", \"contact\": 4, \"mean\": 5, \"inputs\": "
	    "[{\"S1\": 6}]}, {\"name\": \"contact_count\", \"mean\": 7, \"inputs\": [{\"S1\": 8}]}]}]}";
	becomes(json, "output.name,output.contact,output.building,output.storey,output.mean,S1\r\n"
	              "peak_drift_m,,0,1,2,3\r\ngap_needed_m,4,,,5,6\r\ncontact_count,,,,7,8\r\n");
	tabulates(json, "outputs",
	          "output.name,output.contact,output.building,output.storey,output.mean\r\n"
	          "peak_drift_m,,0,1,2\r\ngap_needed_m,4,,,5\r\ncontact_count,,,,7\r\n");
}

static void every_table_of_outputs_says_of_which_place_a_row_is(void **state)
{
	(void)state;
	static const char json[] =
	    "{\"cells\": [{\"outputs\": [{\"name\": \"peak_drift_m\", \"building\": 1, \"storey\": 2, "
	    "\"second_order\": [{\"inputs\": [\"a\", \"b\"], \"S2\": 3}], "
	    "\"closed\": [{\"inputs\": [\"a\"], \"S_closed\": 4}], \"groups\": [{\"name\": \"g\", \"S1\": 5}], "
	    "\"ratios\": {\"explained\": 6, \"variables\": [{\"name\": \"a/b\", \"S1\": 7}]}, "
	    "\"conditional_means\": [{\"name\": \"a\", \"x\": [8], \"mean\": [9], \"low\": [8], \"high\": "
	    "[10]}]}, {\"name\": \"gap_needed_m\", \"contact\": 4, \"building\": null, \"storey\": null, "
	    "\"groups\": [{\"name\": \"g\", \"S1\": 6}]}]}]}";
	tabulates(json, "second_order",
	          "output.name,output.building,output.storey,input_1,input_2,S2\r\npeak_drift_m,1,2,a,b,3\r\n");
	tabulates(json, "closed",
	          "output.name,output.building,output.storey,input_1,S_closed\r\npeak_drift_m,1,2,a,4\r\n");
	tabulates(json, "groups",
	          "output.name,output.contact,output.building,output.storey,name,S1\r\n"
	          "peak_drift_m,,1,2,g,5\r\ngap_needed_m,4,,,g,6\r\n");
	tabulates(json, "ratios",
	          "output.name,output.building,output.storey,explained,name,S1\r\npeak_drift_m,1,2,6,a/b,7\r\n");
	tabulates(json, "conditional_means",
	          "output.name,output.building,output.storey,name,x,mean,low,high\r\n"
	          "peak_drift_m,1,2,a,8,9,8,10\r\n");
}

static void a_cell_is_read_back_as_it_was_written(void **state)
{
	(void)state;
	static const char csv[] = "a,\"b,\"\"c\"\"\",\r\n";
	static const char *const wanted[] = {"a", "b,\"c\"", ""};
	const char *at = csv, *end = csv + sizeof csv - 1;
	for (int k = 0; k < 3; k++) {
		char cell[16], sign;
		at += result_csv_cell(at, end, cell, sizeof cell, &sign);
		assert_string_equal(cell, wanted[k]);
		assert_int_equal(sign, k < 2 ? ',' : '\r');
	}
	assert_ptr_equal(at, end);
}

CHECK_MAIN(cmocka_unit_test(a_row_for_every_cell_output_and_input),
           cmocka_unit_test(error_estimates_stand_by_their_output_and_input),
           cmocka_unit_test(shares_of_the_excitation_stand_by_their_output),
           cmocka_unit_test(a_row_for_every_cell_and_signal),
           cmocka_unit_test(lists_of_sets_have_a_column_for_each_member_of_the_largest),
           cmocka_unit_test(ratios_and_curves_are_tables_of_their_own),
           cmocka_unit_test(every_look_of_a_design_that_grew_is_a_row_whatever_it_found),
           cmocka_unit_test(every_row_of_a_partial_result_says_of_how_many_rows_it_is),
           cmocka_unit_test(a_table_that_a_result_has_not_is_empty),
           cmocka_unit_test(every_list_of_a_study_of_separation_is_a_table),
           cmocka_unit_test(modes_of_buildings_are_a_table),
           cmocka_unit_test(each_contact_of_a_row_has_lines_of_its_own),
           cmocka_unit_test(stories_and_contacts_of_a_row_are_lines),
           cmocka_unit_test(a_line_that_lacks_a_column_leaves_it_empty),
           cmocka_unit_test(every_table_of_outputs_says_of_which_place_a_row_is),
           cmocka_unit_test(a_cell_is_read_back_as_it_was_written),
           cmocka_unit_test(what_is_no_result_gives_no_table))
