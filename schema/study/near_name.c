/* near_name.c - how much two names differ, to guess which one was meant. */
#include "schema/study/near_name.h"

#include <ctype.h>
#include <string.h>

enum { NAME_MAX_LENGTH = 200 }; // no name of a member or choice is longer

/* Edit distance of two names, ignoring case: insertions, deletions, changes and swaps of neighboring letters; 1 if one name is a
 * prefix of the other.
 *
 * Test     unit_fields: a_slip_of_the_pen_is_near_and_a_stranger_is_not
 */
int near_name_distance(const char *a, const char *b)
{
	int n = (int)strnlen(a, NAME_MAX_LENGTH), m = (int)strnlen(b, NAME_MAX_LENGTH);
	int least = n < m ? n : m;
	if (least >= 3 && strncasecmp(a, b, (size_t)least) == 0)
		return n == m ? 0 : 1;
	int rows[3][NAME_MAX_LENGTH + 1]; // rows i - 2, i - 1 and i of the table D[i][j]
	int *before = rows[0], *above = rows[1], *now = rows[2];
	for (int j = 0; j <= m; j++)
		above[j] = j;
	for (int i = 1; i <= n; i++) {
		now[0] = i;
		for (int j = 1; j <= m; j++) {
			int x = tolower((unsigned char)a[i - 1]), y = tolower((unsigned char)b[j - 1]);
			int d = above[j - 1] + (x != y);
			d = above[j] + 1 < d ? above[j] + 1 : d;
			d = now[j - 1] + 1 < d ? now[j - 1] + 1 : d;
			if (i > 1 && j > 1 && x == tolower((unsigned char)b[j - 2]) &&
			    y == tolower((unsigned char)a[i - 2]) && before[j - 2] + 1 < d)
				d = before[j - 2] + 1;
			now[j] = d;
		}
		int *oldest = before;
		before = above;
		above = now;
		now = oldest;
	}
	return above[m];
}

bool near_name(int distance, const char *name)
{
	int third = (int)strnlen(name, NAME_MAX_LENGTH) / 3;
	return distance <= (third < 3 ? third : 3);
}

struct near_name_search near_name_begin(const char *name)
{
	return (struct near_name_search){.name = name};
}

void near_name_try(struct near_name_search *search, const char *choice)
{
	const int distance = near_name_distance(search->name, choice);
	if (search->nearest && distance >= search->distance)
		return;
	search->nearest = choice;
	search->distance = distance;
}

const char *near_name_found(const struct near_name_search *search)
{
	return search->nearest && near_name(search->distance, search->name) ? search->nearest : NULL;
}
