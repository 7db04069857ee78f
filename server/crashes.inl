/* Included by workers.c, before the steps: records the study that a crashing worker works on. */

/* For the crash handler: the study that this thread works on, and the store that records it. */
static _Thread_local volatile int64_t study_here;
static const struct store *crash_store;

static const int crashes[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};

/* Records the study; then the default action of the signal follows. */
static void crash(int signal)
{
	store_blame(crash_store, study_here);
	raise(signal);
}

static void watch_crashes(const struct store *store)
{
	const struct sigaction action = {.sa_handler = crash, .sa_flags = (int)SA_RESETHAND};
	crash_store = store;
	for (size_t i = 0; i < sizeof crashes / sizeof crashes[0]; i++)
		sigaction(crashes[i], &action, NULL);
}
