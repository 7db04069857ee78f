/* The test's side of faults.h. */
#include "tests/support/faults.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "tests/support/check.h"

static void file_of(const char *folder, const char *name, char path[256])
{
	snprintf(path, 256, "%s/%s", folder, name);
}

struct faults *faults_new(const char *folder)
{
	const char *build = getenv("POUND_BUILD");
	char path[256], library[256];
	file_of(folder, "faults", path);
	snprintf(library, sizeof library, "%s/tests/preload.so", build ? build : "build/release");
	int file = open(path, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
	assert_true(file >= 0);
	assert_int_equal(ftruncate(file, sizeof(struct faults)), 0);
	struct faults *faults = mmap(NULL, sizeof *faults, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
	assert_ptr_not_equal(faults, MAP_FAILED);
	close(file);
	assert_true(strlen(folder) < sizeof faults->folder);
	strcpy(faults->folder, folder);
	char *absolute = realpath(library, NULL);
	assert_non_null(absolute);
	setenv("LD_PRELOAD", absolute, 1);
	setenv("ASAN_OPTIONS", "verify_asan_link_order=0", 1);
	setenv(FAULTS_VARIABLE, path, 1);
	free(absolute);
	return faults;
}

void faults_free(struct faults *faults)
{
	unsetenv("LD_PRELOAD");
	unsetenv(FAULTS_VARIABLE);
	munmap(faults, sizeof *faults);
}

void faults_answered(const struct faults *faults, int64_t number)
{
	const struct faults_entry entry = {.event = FAULTS_TOLD, .offset = number};
	char path[256];
	file_of(faults->folder, "record", path);
	int file = open(path, O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0600);
	assert_true(file >= 0);
	assert_int_equal(write(file, &entry, sizeof entry), sizeof entry);
	close(file);
}
