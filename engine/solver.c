/* solver.c - the ways to integrate a scene.  Adding one: its function and its row in solvers[]. */
#include <stddef.h>

#include "engine/pound.h"

static const char *const solvers[] = {"event"};

const char *pound_solver_name(int row)
{
	return row >= 0 && row < (int)(sizeof solvers / sizeof solvers[0]) ? solvers[row] : NULL;
}
