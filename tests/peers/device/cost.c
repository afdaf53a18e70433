// Instruction counts and Cortex-M4 weighted cost per function and per section, for a QEMU 7.2 system-mode run (plugin API 1).
//
// A section is what runs between two calls of functions whose names begin with section_; the later one names it. It counts
// whatever is called in between, so a kernel may be one function or ten.
//
// Counts are exact and repeatable. The cost is an estimate from the Cortex-M4 TRM's instruction timings without flash wait
// states: multiply-accumulate 3, load/store 2 (1 right after another), load/store multiple 1 + registers, ldrd/strd 3,
// branch 3, udiv/sdiv 7, vdiv/vsqrt 14, everything else 1. It is not a hardware cycle count.
//
//   cc -O2 -shared -fPIC -o libcost.so cost.c
//   qemu-system-arm -machine mps2-an386 -nographic -semihosting-config enable=on,target=native
//       -plugin ./libcost.so -d plugin -kernel image.elf
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EXPORT __attribute__((visibility("default")))
typedef uint64_t plugin_id;
struct tb;
struct insn;
typedef struct {
    const char *target_name;
    struct { int min, cur; } version;
    bool system_emulation;
    struct { int smp, max; } system;
} info;

// Prototypes by hand: Debian does not package qemu-plugin.h.
void qemu_plugin_register_vcpu_tb_trans_cb(plugin_id, void (*)(plugin_id, struct tb *));
void qemu_plugin_register_atexit_cb(plugin_id, void (*)(plugin_id, void *), void *);
size_t qemu_plugin_tb_n_insns(const struct tb *);
struct insn *qemu_plugin_tb_get_insn(const struct tb *, size_t);
const char *qemu_plugin_insn_symbol(const struct insn *);
char *qemu_plugin_insn_disas(const struct insn *);
void qemu_plugin_register_vcpu_insn_exec_cb(struct insn *, void (*)(unsigned, void *), int flags, void *);
void qemu_plugin_register_vcpu_insn_exec_inline(struct insn *, int op_add_u64, void *, uint64_t);
void qemu_plugin_outs(const char *);
EXPORT int qemu_plugin_version = 1;

enum { MAX_SYMBOLS = 4096 };
static struct { const char *name; uint64_t count, cost; } symbols[MAX_SYMBOLS];
static int symbol_count;
static uint64_t total, total_cost;

enum { MAX_SECTIONS = 256 };
static struct { const char *name; uint64_t count, cost; } sections[MAX_SECTIONS];
static int section_count;
static uint64_t seen, seen_cost;
static const char SECTION[] = "section_";

static bool starts(const char *text, const char *prefix) { return strncmp(text, prefix, strlen(prefix)) == 0; }
static bool any(const char *text, const char *const *prefixes) {
    for (; *prefixes; prefixes++) if (starts(text, *prefixes)) return true;
    return false;
}
static bool is_load_store(const char *d) {
    static const char *const p[] = {"ldr", "str", "vldr", "vstr", 0};
    return any(d, p);
}
static int register_list(const char *d) {
    const char *p = strchr(d, '{');
    int n = 1;
    for (; p && *p && *p != '}'; p++) n += *p == ',' ? 1 : *p == '-' ? 7 : 0;
    return n;
}
static int weight(const char *d, bool after_load_store) {
    static const char *const mac[] = {"vfma", "vfms", "vfnm", "vmla", "vmls", "vnml", 0};
    static const char *const multiple[] = {"vldm", "vstm", "vpush", "vpop", "ldm", "stm", "push", "pop", 0};
    static const char *const not_branch[] = {"bic", "bfi", "bfc", "bkpt", 0};
    if (any(d, mac)) return 3;
    if (starts(d, "vdiv") || starts(d, "vsqrt")) return 14;
    if (any(d, multiple)) return 1 + register_list(d);
    if (starts(d, "ldrd") || starts(d, "strd")) return 3;
    if (is_load_store(d)) return after_load_store ? 1 : 2;
    if (starts(d, "udiv") || starts(d, "sdiv")) return 7;
    if (starts(d, "cbz") || starts(d, "cbnz")) return 3;
    if (d[0] == 'b' && !any(d, not_branch)) return 3;
    return 1;
}
static int symbol_index(const char *name) {
    int k = 0;
    while (k < symbol_count && strcmp(symbols[k].name, name)) k++;
    if (k == symbol_count && symbol_count < MAX_SYMBOLS - 1) symbols[symbol_count++].name = strdup(name);
    return k;
}
static void section_ends(unsigned cpu, void *name) {
    (void)cpu;
    if (section_count < MAX_SECTIONS) {
        sections[section_count].name = name;
        sections[section_count].count = total - seen;
        sections[section_count++].cost = total_cost - seen_cost;
    }
    seen = total, seen_cost = total_cost;
}
static void translate(plugin_id id, struct tb *block) {
    (void)id;
    bool after_load_store = false;
    for (size_t i = 0, n = qemu_plugin_tb_n_insns(block); i < n; i++) {
        struct insn *insn = qemu_plugin_tb_get_insn(block, i);
        const char *name = qemu_plugin_insn_symbol(insn);
        int k = symbol_index(name ? name : "?");
        qemu_plugin_register_vcpu_insn_exec_inline(insn, 0, &total, 1);
        qemu_plugin_register_vcpu_insn_exec_inline(insn, 0, &symbols[k].count, 1);
        char *text = qemu_plugin_insn_disas(insn);
        if (!text) continue;
        qemu_plugin_register_vcpu_insn_exec_inline(insn, 0, &symbols[k].cost, weight(text, after_load_store));
        qemu_plugin_register_vcpu_insn_exec_inline(insn, 0, &total_cost, weight(text, after_load_store));
        // Such a function is one instruction, its return.
        if (starts(symbols[k].name, SECTION))
            qemu_plugin_register_vcpu_insn_exec_cb(insn, section_ends, 0, (void *)(symbols[k].name + sizeof SECTION - 1));
        after_load_store = is_load_store(text);
        free(text);
    }
}
static void report(plugin_id id, void *data) {
    (void)id, (void)data;
    char line[512];
    snprintf(line, sizeof line, "total\t%llu\n", (unsigned long long)total);
    qemu_plugin_outs(line);
    for (int k = 0; k < section_count; k++) {
        snprintf(line, sizeof line, "section %s\t%llu\t%llu\n", sections[k].name, (unsigned long long)sections[k].count,
                 (unsigned long long)sections[k].cost);
        qemu_plugin_outs(line);
    }
    for (int k = 0; k < symbol_count; k++) {
        snprintf(line, sizeof line, "%s\t%llu\t%llu\n", symbols[k].name, (unsigned long long)symbols[k].count,
                 (unsigned long long)symbols[k].cost);
        qemu_plugin_outs(line);
    }
}
EXPORT int qemu_plugin_install(plugin_id id, const info *about, int argc, char **argv) {
    (void)about, (void)argc, (void)argv;
    qemu_plugin_register_vcpu_tb_trans_cb(id, translate);
    qemu_plugin_register_atexit_cb(id, report, 0);
    return 0;
}
