/* The default of --memory-max: files of a simulated machine in a folder of the test. */
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "server/memory.h"
#include "tests/support/check.h"

static char root[] = "/tmp/pound-memory-XXXXXX";

static void write_file(const char *path, const char *text)
{
	char whole[PATH_MAX];
	snprintf(whole, sizeof whole, "%s%s", root, path);
	for (char *c = whole + strlen(root) + 1; (c = strchr(c, '/')); *c++ = '/') {
		*c = '\0';
		mkdir(whole, 0700);
	}
	FILE *file = fopen(whole, "w");
	assert_non_null(file);
	fputs(text, file);
	fclose(file);
}

static void half_of_the_machine_or_of_the_least_control_group(void **state)
{
	(void)state;
	assert_non_null(mkdtemp(root));
	write_file("/proc/meminfo", "MemTotal:        8388608 kB\nMemFree:  1 kB\n");
	assert_int_equal(memory_share(root), 4096);
	// version 2: the group has no limit, its parent has one
	write_file("/proc/self/cgroup", "0::/system.slice/poundd.service\n");
	write_file("/sys/fs/cgroup/system.slice/poundd.service/memory.max", "max\n");
	assert_int_equal(memory_share(root), 4096);
	write_file("/sys/fs/cgroup/system.slice/memory.max", "1073741824\n");
	assert_int_equal(memory_share(root), 512);
	write_file("/sys/fs/cgroup/system.slice/poundd.service/memory.max", "629145600\n");
	assert_int_equal(memory_share(root), 300);
	// version 1, where no limit is a large number; the group of a container may be the visible root
	write_file("/proc/self/cgroup", "9:cpu:/x\n4:memory:/docker/1\n0::/none\n");
	assert_int_equal(memory_share(root), 4096);
	write_file("/sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n");
	assert_int_equal(memory_share(root), 4096);
	write_file("/sys/fs/cgroup/memory/docker/1/memory.limit_in_bytes", "268435456\n");
	assert_int_equal(memory_share(root), 128);
	char remove[PATH_MAX];
	snprintf(remove, sizeof remove, "rm -r %s", root);
	assert_int_equal(system(remove), 0);
	// also known for this machine
	check_report("this machine: %d MiB", memory_share(""));
	assert_true(memory_share("") > 1 && memory_share("") < INT_MAX);
}

CHECK_MAIN(cmocka_unit_test(half_of_the_machine_or_of_the_least_control_group))
