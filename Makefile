# bcifs: `make` builds, `make demo` draws, `make check` tests, `make bench` measures,
# `make install PREFIX=… DESTDIR=…` installs.

VERSION := 0.1.0
SONAME_VERSION := 0

BUILD ?= build
PREFIX ?= /usr/local
DESTDIR ?=
CC ?= cc
AR ?= ar
PROVE ?= prove
JOBS ?= $(shell getconf _NPROCESSORS_ONLN 2>/dev/null || echo 1)
INSTALL ?= install

# -ffp-contract=off: results must not depend on whether the machine has a fused multiply-add.
CFLAGS ?= -O2
WARNINGS := -Wall -Wextra -Wpedantic -Wconversion -Wshadow
ifdef DEBUG
CFLAGS := -O0 -g3
endif
ifdef SANITIZE
CFLAGS += -g -fsanitize=$(SANITIZE) -fno-sanitize-recover=all -fno-omit-frame-pointer
LDFLAGS += -fsanitize=$(SANITIZE)
endif
ifdef STRICT
WARNINGS += -Werror
endif
ALL_CFLAGS := -std=c11 -D_POSIX_C_SOURCE=200809L $(WARNINGS) -ffp-contract=off -fPIC -fvisibility=hidden \
	-Iinclude -Ilib $(CFLAGS)
LIBS := -lm -pthread

LIBRARY_SOURCES := $(filter-out lib/command/%,$(wildcard lib/*/*.c))
COMMAND_SOURCES := $(wildcard lib/command/*.c)
UNIT_SOURCES := $(wildcard tests/unit/*.c)
BENCH_SOURCES := $(wildcard tests/bench/*.c)
LIBRARY_OBJECTS := $(LIBRARY_SOURCES:%.c=$(BUILD)/object/%.o)
COMMAND_OBJECTS := $(COMMAND_SOURCES:%.c=$(BUILD)/object/%.o)
BENCH_OBJECTS := $(BENCH_SOURCES:%.c=$(BUILD)/object/%.o)
UNIT_TESTS := $(UNIT_SOURCES:tests/unit/%.c=$(BUILD)/tests/%.t)
COMMAND_TESTS := $(wildcard tests/command/*.t)
GALLERY := $(wildcard automata/*.bcifs)

SHARED := libbcifs.so.$(VERSION)

# What `make bench` measures: all, or what begins with one of these.
BENCH ?=

.PHONY: all demo check bench install uninstall clean

all: $(BUILD)/bcifs $(BUILD)/libbcifs.a $(BUILD)/libbcifs.so

# The flags a build was made with: changing them rebuilds everything.
FLAGS_NOW := $(CC) $(ALL_CFLAGS) $(LDFLAGS)
$(BUILD)/flags: force
	@mkdir -p $(BUILD)
	@echo '$(FLAGS_NOW)' | cmp -s - $@ || echo '$(FLAGS_NOW)' > $@
.PHONY: force

$(BUILD)/object/%.o: %.c $(BUILD)/flags
	@mkdir -p $(@D)
	$(CC) $(ALL_CFLAGS) -MMD -MP -c -o $@ $<

$(BUILD)/libbcifs.a: $(LIBRARY_OBJECTS)
	rm -f $@
	$(AR) rcs $@ $^

$(BUILD)/$(SHARED): $(LIBRARY_OBJECTS)
	$(CC) $(CFLAGS) $(LDFLAGS) -shared -Wl,-soname,libbcifs.so.$(SONAME_VERSION) -o $@ $^ $(LIBS)

$(BUILD)/libbcifs.so: $(BUILD)/$(SHARED)
	ln -sf $(SHARED) $(BUILD)/libbcifs.so.$(SONAME_VERSION)
	ln -sf libbcifs.so.$(SONAME_VERSION) $@

$(BUILD)/bcifs: $(COMMAND_OBJECTS) $(BUILD)/libbcifs.a
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ $(LIBS)

$(BUILD)/tests/%.t: tests/unit/%.c $(BUILD)/libbcifs.a $(BUILD)/flags
	@mkdir -p $(@D)
	$(CC) $(ALL_CFLAGS) $(LDFLAGS) -MMD -MP -MT $@ -MF $(@:.t=.d) -o $@ $< $(BUILD)/libbcifs.a $(LIBS)

$(BUILD)/bench: $(BENCH_OBJECTS) $(BUILD)/libbcifs.a
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ $(LIBS)

bench: $(BUILD)/bench
	$(BUILD)/bench -o $(BUILD)/bench.json $(BENCH)

demo: $(BUILD)/bcifs
	@mkdir -p $(BUILD)/demo
	$(BUILD)/bcifs check automata/chaikin.bcifs
	$(BUILD)/bcifs eval automata/chaikin.bcifs --depth 7 --polygon -o $(BUILD)/demo/chaikin.svg
	$(BUILD)/bcifs check automata/takagi.bcifs
	$(BUILD)/bcifs eval automata/takagi.bcifs --depth 12 --polygon -o $(BUILD)/demo/takagi.svg
	@echo
	@echo "Look at: $(BUILD)/demo/chaikin.svg and $(BUILD)/demo/takagi.svg"

check: all $(UNIT_TESTS)
	BCIFS=$(BUILD)/bcifs BUILD=$(BUILD) CC='$(CC)' $(PROVE) -j$(JOBS) --exec '' $(UNIT_TESTS) $(COMMAND_TESTS)

install: all
	$(INSTALL) -d $(DESTDIR)$(PREFIX)/bin $(DESTDIR)$(PREFIX)/lib/pkgconfig $(DESTDIR)$(PREFIX)/include \
		$(DESTDIR)$(PREFIX)/share/man/man1 $(DESTDIR)$(PREFIX)/share/bcifs/automata
	$(INSTALL) -m 755 $(BUILD)/bcifs $(DESTDIR)$(PREFIX)/bin/bcifs
	$(INSTALL) -m 644 $(BUILD)/libbcifs.a $(DESTDIR)$(PREFIX)/lib/libbcifs.a
	$(INSTALL) -m 755 $(BUILD)/$(SHARED) $(DESTDIR)$(PREFIX)/lib/$(SHARED)
	ln -sf $(SHARED) $(DESTDIR)$(PREFIX)/lib/libbcifs.so.$(SONAME_VERSION)
	ln -sf libbcifs.so.$(SONAME_VERSION) $(DESTDIR)$(PREFIX)/lib/libbcifs.so
	$(INSTALL) -m 644 include/bcifs.h $(DESTDIR)$(PREFIX)/include/bcifs.h
	$(INSTALL) -m 644 docs/bcifs.1 $(DESTDIR)$(PREFIX)/share/man/man1/bcifs.1
	$(INSTALL) -m 644 $(GALLERY) $(DESTDIR)$(PREFIX)/share/bcifs/automata
	sed -e 's|@PREFIX@|$(PREFIX)|' -e 's|@VERSION@|$(VERSION)|' docs/bcifs.pc.in \
		> $(DESTDIR)$(PREFIX)/lib/pkgconfig/bcifs.pc
	chmod 644 $(DESTDIR)$(PREFIX)/lib/pkgconfig/bcifs.pc

uninstall:
	rm -f $(DESTDIR)$(PREFIX)/bin/bcifs $(DESTDIR)$(PREFIX)/include/bcifs.h \
		$(addprefix $(DESTDIR)$(PREFIX)/lib/,libbcifs.a $(SHARED) libbcifs.so.$(SONAME_VERSION) libbcifs.so) \
		$(DESTDIR)$(PREFIX)/lib/pkgconfig/bcifs.pc $(DESTDIR)$(PREFIX)/share/man/man1/bcifs.1 \
		$(addprefix $(DESTDIR)$(PREFIX)/share/bcifs/,$(GALLERY))
	-rmdir $(DESTDIR)$(PREFIX)/share/bcifs/automata $(DESTDIR)$(PREFIX)/share/bcifs 2>/dev/null

clean:
	rm -rf $(BUILD)

-include $(wildcard $(BUILD)/object/*/*/*.d $(BUILD)/tests/*.d)
