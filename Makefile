# make run, make test: all a fresh Debian 12 needs.  MODE=asan|tsan|debug, CC=clang, T=substring of names of tests, MPI=1: ranks.
MODE ?= release
# make's own rules would try to build march_*.d, which it includes, out of exact.inl
MAKEFLAGS += --no-builtin-rules
B    := build/$(MODE)

MODE.release := -O2 -g
MODE.debug   := -Og -g
# what is left of a mistake with memory is an end, not a way in; the sanitizers see more without it
CPPFLAGS.release := -D_FORTIFY_SOURCE=2
LDFLAGS.release  := -pie -Wl,-z,relro,-z,now
MODE.asan    := -O1 -g -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer
MODE.tsan    := -O1 -g -fsanitize=thread
# the march's loops over lanes are to be straight code, each function from a cache line on; no index of an array on its stack comes
# from a study
MARCH.release := -O3 -fno-tree-vectorize -fno-stack-protector -falign-functions=64
# a floor is followed by short loops over the orders of a series
FLOOR.release := -O3 -funroll-loops
# passes over samples, in vectors
NOISE.release := -O3
# rotations of two rows of a building's shapes
MODES.release := -O3
WARN     := -Wall -Wextra -Werror -Wmissing-prototypes -Wshadow -Wvla -Wno-psabi
CPPFLAGS += -I. -D_GNU_SOURCE $(CPPFLAGS.$(MODE))
LDFLAGS  += $(LDFLAGS.$(MODE))
CFLAGS   += -std=c17 $(WARN) -ffp-contract=off -fno-math-errno -fstack-protector-strong -MMD -MP $(MODE.$(MODE))

# a jump over a multiple of 32 bytes costs the first AVX-512 processors their cache of decoded code
comma    := ,
JUMPS    := $(if $(findstring clang,$(CC)),,-Wa$(comma))-mbranches-within-32B-boundaries

# NAME.inl of the engine is compiled once per lane count, as NAME_w8.c and so on, chosen among at run time; all give the
# same bits
LANES.w1 := -mfma
LANES.w4 := -mavx2 -mfma
LANES.w8 := -mavx512f -mavx512dq -mavx512vl -mfma -mprefer-vector-width=512 -mtune=skylake-avx512 $(JUMPS)

PACKAGES := gcc make pkg-config libgsl-dev libmicrohttpd-dev libsqlite3-dev libcjson-dev librandom123-dev \
            nettle-dev libcurl4-openssl-dev libcmocka-dev curl

PACKAGES += $(if $(filter 1,$(MPI)),openmpi-bin libopenmpi-dev)

PACKAGES += $(if $(filter simgrid,$(MAKECMDGOALS)),libsimgrid-dev)

LIBS.engine := -lgsl -lgslcblas -lm
LIBS.schema := -lcjson -lnettle
LIBS.server := -lmicrohttpd -lsqlite3 -lpthread
LIBS.client := -lcurl -lcjson -lpthread
LIBS.tests  := -lcmocka -lcurl

# the objects of a folder and of its rooms, but for some
objs   = $(patsubst %.c,$(B)/%.o,$(filter-out $(2),$(wildcard $(1)/*.c $(1)/*/*.c)))
ENGINE := $(call objs,engine)
SCHEMA := $(call objs,schema) $(B)/schema/examples.o $(B)/schema/page.o
SERVER := $(call objs,server,server/main.c)
# one of these asks servers: the second says that it cannot (make client CURL=0)
WIRE   := client/wire.c client/offline.c
# programs of their own: they run blocks for other processes, the second as ranks of MPI (make MPI=1)
WORKER := client/worker.c client/thread_pool.c client/worker_connection.c
RANKS  := client/worker_ranks.c client/thread_pool.c client/worker_connection.c
MPICC  ?= mpicc
CLIENT := $(call objs,client,$(WIRE) $(WORKER) $(RANKS))
# a program each; the files of tests/support serve them all
TESTS   := $(patsubst %.c,$(B)/%,$(wildcard tests/unit/*/*.c tests/service/*.c tests/client/*.c))
# what takes minutes is built with the tests, so that no change breaks it unseen
LONG    := $(patsubst %.c,$(B)/%,$(wildcard tests/long/soak_*.c)) $(addprefix $(B)/tests/long/,bench paper statistics) \
           $(call objs,tests/fuzz)
FIXTURE := $(call objs,tests/support,tests/support/preload.c tests/support/instant_blocks.c)

all: $(B)/poundd $(B)/pound $(B)/pound-worker $(if $(filter 1,$(MPI)),$(B)/pound-worker-mpi)

$(B)/libpound.a: $(ENGINE)
	@rm -f $@; $(AR) rcs $@ $^
$(B)/poundd: $(B)/server/main.o $(SERVER) $(SCHEMA) $(B)/libpound.a
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ $(LIBS.server) $(LIBS.schema) $(LIBS.engine)
$(B)/pound: $(CLIENT) $(B)/client/wire.o $(SCHEMA) $(B)/libpound.a
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ $(LIBS.client) $(LIBS.schema) $(LIBS.engine)
$(B)/pound-worker: $(WORKER:%.c=$(B)/%.o) $(SCHEMA) $(B)/libpound.a
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ $(LIBS.schema) $(LIBS.engine) -lpthread
$(B)/client/worker_ranks.o $(B)/pound-worker-mpi: override CC := $(MPICC)
$(B)/pound-worker-mpi: $(RANKS:%.c=$(B)/%.o) $(SCHEMA) $(B)/libpound.a
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ $(LIBS.schema) $(LIBS.engine) -lpthread
$(B)/tests/%: $(B)/tests/%.o $(FIXTURE) $(SERVER) $(SCHEMA) $(B)/libpound.a
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ $(LIBS.tests) $(LIBS.server) $(LIBS.schema) $(LIBS.engine)

# the command line and workers, for clusters: GSL, cJSON, nettle and Random123; CURL=0: without libcurl
CURL ?= 1
$(B)/client/pound: $(CLIENT) $(B)/client/$(if $(filter 0,$(CURL)),offline.o,wire.o) $(SCHEMA) $(B)/libpound.a FORCE
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $(filter-out FORCE,$^) $(if $(filter 0,$(CURL)),$(filter-out -lcurl,$(LIBS.client)),$(LIBS.client)) \
	  $(LIBS.schema) $(LIBS.engine)
client: $(B)/client/pound $(B)/pound-worker $(if $(filter 1,$(MPI)),$(B)/pound-worker-mpi)
	@echo $^
FORCE:

# workers whose blocks take no time
INSTANT := $(B)/tests/worker-instant $(if $(filter 1,$(MPI)),$(B)/tests/ranks-instant)
$(B)/tests/ranks-instant: override CC := $(MPICC)
$(B)/tests/worker-instant: $(WORKER:%.c=$(B)/%.o)
$(B)/tests/ranks-instant: $(RANKS:%.c=$(B)/%.o)
$(B)/tests/worker-instant $(B)/tests/ranks-instant: $(B)/tests/support/instant_blocks.o $(SCHEMA) $(B)/libpound.a
	$(CC) $(CFLAGS) $(LDFLAGS) -Wl,--wrap=pound_run_block -o $@ $^ $(LIBS.schema) $(LIBS.engine) -lpthread
$(B)/tests/long/soak_limits: | $(INSTANT)
# the test's own blocks crash in their place
$(B)/tests/service/service_poison: LDFLAGS += -Wl,--wrap=pound_run_create_by,--wrap=pound_run_block
# GSL's memory is that of the test
$(B)/tests/unit/run/unit_status: LDFLAGS += -Wl,--wrap=gsl_odeiv2_driver_alloc_scaled_new
# a contact model is given another form of force
$(B)/tests/unit/study/unit_capabilities: LDFLAGS += -Wl,--wrap=pound_contact_force
# one lane width is asked for
$(B)/tests/unit/run/unit_golden: LDFLAGS += -Wl,--wrap=pound_dispatch_width
# between a poundd of the tests and the C library: tests/support/faults.h
$(TESTS): | $(B)/tests/preload.so
$(B)/tests/preload.so: tests/support/preload.c tests/support/faults.h
	@mkdir -p $(@D)
	$(CC) $(CPPFLAGS) $(filter-out -MMD -MP,$(CFLAGS)) -U_FORTIFY_SOURCE -fPIC -shared -o $@ $<

$(B)/%.o: %.c
	@mkdir -p $(@D)
	$(CC) $(CPPFLAGS) $(CFLAGS) -c -o $@ $<
$(B)/%_w1.o: CFLAGS += $(LANES.w1)
$(B)/%_w4.o: CFLAGS += $(LANES.w4)
$(B)/%_w8.o: CFLAGS += $(LANES.w8)
$(B)/engine/exact/exact_%.o: CFLAGS += $(MARCH.$(MODE))
$(B)/engine/exact/chain_%.o: CFLAGS += $(MARCH.$(MODE))
$(B)/engine/ground/noise_%.o: CFLAGS += $(NOISE.$(MODE))
$(B)/engine/floor/oscillator_bank_%.o: CFLAGS += $(FLOOR.$(MODE))
$(B)/engine/floor/floor_pieces.o: CFLAGS += $(FLOOR.$(MODE))
$(B)/engine/scene/modes.o: CFLAGS += $(MODES.$(MODE))

# the database's schema is built into the server, as a C string
$(B)/server/store.sql.inc: server/store.sql
	@mkdir -p $(@D)
	sed 's/[\\"]/\\&/g; s/.*/"&\\n"/' $< > $@
$(B)/server/database.o: $(B)/server/store.sql.inc
$(B)/server/database.o: CPPFLAGS += -I$(B)

# the study documents of schema/examples are built into the programs: name, title, text
$(B)/schema/examples.c: $(wildcard schema/examples/*.json)
	@mkdir -p $(@D)
	@{ echo '#include "schema/examples/examples.h"'; echo 'const struct example examples[] = {'; \
	  for f in $^; do name=$${f##*/}; echo "{\"$${name%.json}\","; \
	    sed -n 's/^  "name": \(".*"\),$$/\1,/p' $$f; sed 's/[\\"]/\\&/g; s/.*/"&\\n"/' $$f; echo '},'; done; \
	  echo '{0}};'; } >$@
$(B)/schema/examples.o: $(B)/schema/examples.c
	$(CC) $(CPPFLAGS) $(CFLAGS) -c -o $@ $<

# and so are the pages for browsers, which are text: name, text
$(B)/schema/page.c: $(wildcard client/page/*)
	@mkdir -p $(@D)
	@{ echo '#include "schema/http/page.h"'; echo 'const struct page_file page_files[] = {'; \
	  for f in $^; do echo "{\"$${f##*/}\","; sed 's/[\\"?]/\\&/g; s/.*/"&\\n"/' $$f; echo '},'; done; \
	  echo '{0}};'; } >$@
$(B)/schema/page.o: $(B)/schema/page.c
	$(CC) $(CPPFLAGS) $(CFLAGS) -c -o $@ $<

# install what is missing, and only that
deps:
	@missing=$$(for p in $(PACKAGES); do dpkg -s $$p >/dev/null 2>&1 || echo $$p; done); \
	[ -z "$$missing" ] || { as=$$([ $$(id -u) = 0 ] || echo sudo); $$as apt-get update -q && \
	  $$as env DEBIAN_FRONTEND=noninteractive apt-get install -qy --no-install-recommends $$missing; }

# what the test of the pages needs, which is skipped without it
browser:
	@as=$$([ $$(id -u) = 0 ] || echo sudo); $$as apt-get update -q && \
	  $$as env DEBIAN_FRONTEND=noninteractive apt-get install -qy --no-install-recommends chromium

run: deps
	@$(MAKE) --no-print-directory -s all
	@tests/run-paper $(B)
test: deps
	@$(MAKE) --no-print-directory -j$$(nproc) -s lint
	@$(MAKE) --no-print-directory -j$$(nproc) -s check
check: all $(TESTS) $(LONG)
	@tests/run-tests $(B) $(T)
# how fast the engine is, a table; ROWS of the paper campaign's design, for trials; PART: one group of rows
ROWS ?= 1000
bench: $(B)/tests/long/bench
	@$< $(ROWS) $(PART)
$(B)/tests/long/bench: $(patsubst %.c,$(B)/%.o,$(wildcard tests/long/bench_*.c))
# what the engine is measured against is to be as fast as a compiler makes it
$(B)/tests/support/baseline_loop.o $(B)/tests/support/baseline_chain.o: CFLAGS += -O3
# the paper's findings, one by one, over the duration of the motions: some ten minutes; PAPER_ROWS for trials
PAPER_ROWS ?= 1000
paper: $(B)/tests/long/paper
	@$< $(PAPER_ROWS)
$(B)/tests/long/paper: $(patsubst %.c,$(B)/%.o,$(wildcard tests/long/paper_*.c))
# the result bytes of every example, whole, at every lane width and by 1, 2 and 4 threads: minutes
golden: $(B)/tests/unit/run/unit_golden
	@POUND_GOLDEN=whole $<
# stiff and extreme scenes, a table: what every one of them is checked for by the tests
extremes: $(B)/tests/unit/exact/unit_extremes $(B)/tests/unit/exact/unit_chain_extremes
	@for table in $^; do $$table | grep '^|'; done
# searches for the yield displacement of a target demand, a table: how many end at it, by law and corrections
yield: $(B)/tests/unit/run/unit_yield
	@$< | grep '^|'
# how good the indices are: errors, coverage and bias over SEEDS designs of functions with exact indices; minutes
SEEDS ?= 200
statistics: $(B)/tests/long/statistics
	@$< $(SEEDS)
$(B)/tests/long/statistics: $(patsubst %.c,$(B)/%.o,$(wildcard tests/long/statistics_*.c))
# what takes minutes of a quiet machine: many and slow clients for SOAK seconds each, then the server's tests with more
# kills, cuts and failures, MORE of 100 of them; every line that begins with # is a measurement
SOAK ?= 60
MORE ?= 100
soak: all $(filter $(B)/tests/long/soak_%,$(LONG)) $(filter $(B)/tests/service/%,$(TESTS))
	@KINDS='soak service' SOAK=$(SOAK) POUND_SOAK=$(MORE) tests/run-tests $(B) $(T)
# a study on up to 1,000 threads of a cluster, simulated by SimGrid with block times measured here: a minute
simgrid: deps
	@$(MAKE) --no-print-directory -s $(B)/tests/long/simgrid
	@$(B)/tests/long/simgrid --log=root.thres:error
$(B)/tests/long/simgrid: $(B)/tests/long/simgrid.o $(SCHEMA) $(B)/libpound.a
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ -lsimgrid $(LIBS.schema) $(LIBS.engine)
# threads that have ended when a server does not wait for those that have not are no leak
tsan: export TSAN_OPTIONS ?= report_thread_leaks=0
asan tsan:
	@$(MAKE) --no-print-directory -j$$(nproc) MODE=$@ -s check

# rules of the house: who includes what, what the engine may call, layout, sizes
lint: $(B)/libpound.a
	@tests/lint $(B)
# FUZZ seconds for each target of tests/fuzz/fuzz_*.c, starting from its corpus and the examples; what breaks is left in
# build/fuzz, what is new in build/fuzz/*.corpus (`-merge=1 tests/corpus/NAME` keeps the part that adds something)
FUZZ  ?= 60
fuzz: $(patsubst tests/fuzz/%.c,build/fuzz/%,$(wildcard tests/fuzz/fuzz_*.c))
	@for target in $^; do mkdir -p $$target.corpus && \
	  $$target -max_total_time=$(FUZZ) -max_len=8192 -artifact_prefix=$$target- $$target.corpus \
	    tests/corpus/$${target##*/fuzz_} schema/examples || exit 1; done
build/fuzz/%: tests/fuzz/%.c $(wildcard schema/*/*.c) $(B)/schema/examples.c $(B)/libpound.a
	@mkdir -p $(@D)
	clang -std=c17 -g -O1 -fsanitize=fuzzer,address,undefined -fno-sanitize-recover=all $(CPPFLAGS) -o $@ $^ \
	  $(LIBS.schema) $(LIBS.engine)

# programs, manual pages, a systemd unit, pound.py and completions; DESTDIR goes before PREFIX
PREFIX    ?= /usr/local
PYTHONDIR ?= $(PREFIX)/lib/python3/dist-packages
BASHDIR   ?= $(PREFIX)/share/bash-completion/completions
ZSHDIR    ?= $(PREFIX)/share/zsh/site-functions
FISHDIR   ?= $(PREFIX)/share/fish/vendor_completions.d
install: all
	install -d $(addprefix $(DESTDIR)$(PREFIX)/,bin share/man/man1 share/man/man8 lib/systemd/system) \
	  $(addprefix $(DESTDIR),$(PYTHONDIR) $(BASHDIR) $(ZSHDIR) $(FISHDIR))
	install $(B)/poundd $(B)/pound $(B)/pound-worker $(if $(filter 1,$(MPI)),$(B)/pound-worker-mpi) $(DESTDIR)$(PREFIX)/bin
	client/manual $(B)/pound client/pound.1 >$(DESTDIR)$(PREFIX)/share/man/man1/pound.1
	client/manual $(B)/pound-worker client/pound-worker.1 >$(DESTDIR)$(PREFIX)/share/man/man1/pound-worker.1
	client/manual $(B)/poundd server/poundd.8 >$(DESTDIR)$(PREFIX)/share/man/man8/poundd.8
	sed 's|@PREFIX@|$(PREFIX)|' server/poundd.service >$(DESTDIR)$(PREFIX)/lib/systemd/system/poundd.service
	install -m 644 client/pound.py $(DESTDIR)$(PYTHONDIR)
	install -m 644 client/pound.bash $(DESTDIR)$(BASHDIR)/pound
	install -m 644 client/_pound $(DESTDIR)$(ZSHDIR)
	install -m 644 client/pound.fish $(DESTDIR)$(FISHDIR)

# the sources as a tarball, and as Debian packages, in build/dist; the same bytes for the same sources and SOURCE_DATE_EPOCH
VERSION := $(shell sed -n 's/^#define POUND_VERSION "\(.*\)"/\1/p' engine/pound.h)
NAME    := pound-$(VERSION)
export SOURCE_DATE_EPOCH ?= $(or $(shell git log -1 --format=%ct 2>/dev/null),0)
dist:
	@mkdir -p build/dist
	@{ git ls-files 2>/dev/null || find . -path ./build -prune -o -type f -print | sed 's|^./||'; } | LC_ALL=C sort | \
	  tar --transform 's|^|$(NAME)/|' --owner=0 --group=0 --numeric-owner --mode=go=rX,u+rw --mtime=@$(SOURCE_DATE_EPOCH) -cf - -T - | \
	  gzip -n >build/dist/$(NAME).tar.gz
	@echo build/dist/$(NAME).tar.gz
deb: dist
	@$(RM) -r build/dist/$(NAME)
	@tar -xzf build/dist/$(NAME).tar.gz -C build/dist
	@client/debian build/dist/$(NAME) $(VERSION)
	@cd build/dist/$(NAME) && env -u MAKEFLAGS -u MAKELEVEL CC='$(CC)' DEB_BUILD_OPTIONS=parallel=$$(nproc) \
	  dpkg-buildpackage -b -us -uc >../$(NAME).log 2>&1 || { tail -30 ../$(NAME).log; exit 1; }
	@ls -s --block-size=1 build/dist/*.deb

fmt:
	clang-format -i $$(git ls-files '*.c' '*.h' '*.inl')
clean:
	$(RM) -r build

# .dockerignore keeps what is built out of a container's build (server/Dockerfile)
.PHONY: all browser client dist deb deps run test check soak install bench golden paper extremes yield statistics simgrid asan tsan lint fuzz fmt clean
.SECONDARY:
-include $(shell find build -path build/dist -prune -o -name '*.d' -type f -print 2>/dev/null)
