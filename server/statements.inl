/* The prepared statements: a name and an SQL text each.  Included by server/store.c, before its functions. */
// clang-format off
enum statement {
	STUDY, LIST, LIST_OF, DOCUMENT, LENGTH, BLOCKS, COUNT, REUSABLE, EXPIRED, EXPIRED_BLOCKS, RECORD, RECORDS_EXPIRED,
	BEGIN, // the first statement of the writer alone
	COMMIT, ROLLBACK, KEYED, SAME, NEXT, SUBMIT, ADD, CANCEL, DELETE, CLAIM, KEEP, PROGRESS, PRUNE, SHED, RECOUNT, SPENT, FINISH, REQUEUE,
	STOPPED, VAIN, POISON, REPLACE_RECORD, ADD_RECORD, NAME_RECORD, FORGET_RECORDS,
	N_STATEMENTS
};

_Static_assert((int)N_STATEMENTS <= (int)DATABASE_STATEMENTS_MAX, "a statement has its place");

#define NOW "CAST(round((julianday('now') - 2440587.5) * 86400000) AS INTEGER)"
#define ISO_TIME(column) "strftime('%Y-%m-%dT%H:%M:%fZ', " column " / 1000.0, 'unixepoch'), "
// queue position of a study, and remaining CPU time of the studies before it, when they run in order
#define QUEUE                                                                                             \
	"iif(status = 'queued', (SELECT count(*) FROM study AS other WHERE other.status = 'queued' "          \
	"AND other.id <= study.id), 0), "                                                                     \
	"iif(status = 'queued', (SELECT total(max(0, other.cpu_s_estimated - other.cpu_s)) FROM study AS other "  \
	"WHERE other.status = 'running' OR (other.status = 'queued' AND other.id < study.id)), 0) "
#define STUDY_ROW                                                                                         \
	"SELECT id, status, kind, name, " ISO_TIME("created") ISO_TIME("started") ISO_TIME("finished")        \
	"error, runs, iif(status = 'succeeded', runs, runs_done), cpu_s, cpu_s_estimated, " QUEUE "FROM study "
#define QUEUED "SELECT id FROM study WHERE status = 'queued' "
// digests that bytes are checked with: of their place and the bytes; the place of a block includes its engine version
#define DOCUMENT_DIGEST(study, name, content) "digest(" name " || ' ' || " study " || ' ', " content ")"
#define BLOCK_DIGEST(study, number, content) \
	"digest('" POUND_VERSION " ' || " study " || ' ' || " number " || ' ', " content ")"

// sums over the blocks of a study, as columns of the study
#define BLOCK_SUMS(cpu_s) \
	"(runs_done, cpu_s) = (SELECT coalesce(sum(runs), 0), " cpu_s " FROM block WHERE study = ?1)"

// filters of a list; NULL: any
#define ALIKE " AND (?4 IS NULL OR instr(name, ?4) > 0) AND (?5 IS NULL OR hash = ?5) "
// a study that ended more than ?1 milliseconds ago
#define EXPIRY "SELECT id FROM study WHERE finished < " NOW " - ?1 "

// a record that no study names, sent more than ?1 milliseconds ago
#define UNNAMED "created < " NOW " - ?1 AND NOT EXISTS (SELECT 1 FROM study_record WHERE record = record.sha256) "

static const char *const statement_text[] = {
	[STUDY]    = STUDY_ROW "WHERE id = ?1",
	[LIST]     = STUDY_ROW "WHERE id < ?1" ALIKE "ORDER BY id DESC LIMIT ?2",
	[LIST_OF]  = STUDY_ROW "WHERE id < ?1" ALIKE "AND status = ?3 ORDER BY id DESC LIMIT ?2",
	[DOCUMENT] = "SELECT content, sha256 = " DOCUMENT_DIGEST("study", "name", "content") " "
	              "FROM document WHERE study = ?1 AND name = ?2",
	[LENGTH]   = "SELECT length(content), rowid, sha256 FROM document WHERE study = ?1 AND name = ?2",
	[BLOCKS]   = "SELECT content, sha256 = " BLOCK_DIGEST("study", "number", "content") ", "
	              "number, runs, cpu_s, wall_s FROM block WHERE study = ?1 ORDER BY number",
	[COUNT]    = "SELECT count(*) FROM (SELECT 1 FROM study WHERE status = ?1 AND (?2 IS NULL OR client = ?2) LIMIT ?3)",
	[REUSABLE] = "SELECT freelist_count * page_size FROM pragma_freelist_count(), pragma_page_size()",
	[EXPIRED]  = EXPIRY "LIMIT 1",
	[EXPIRED_BLOCKS] = EXPIRY "AND EXISTS (SELECT 1 FROM block WHERE study = id) LIMIT 1",
	[RECORD]   = "SELECT content, sha256 = lower(hex(digest('', content))) FROM record WHERE sha256 = ?1",
	[RECORDS_EXPIRED] = "SELECT 1 FROM record WHERE " UNNAMED "LIMIT 1",
	[BEGIN]    = "BEGIN IMMEDIATE",
	[COMMIT]   = "COMMIT",
	[ROLLBACK] = "ROLLBACK",
	[KEYED]    = "SELECT id FROM study WHERE idempotency_key = ?1",
	[SAME]     = "SELECT study FROM document WHERE study = ?1 AND name = 'request' AND content = ?2",
	[NEXT]     = "SELECT max((" NOW " << 20) + (random() & 0xfffff), (SELECT coalesce(max(id), 0) + 1 FROM study))",
	[SUBMIT]   = "INSERT INTO study (id, status, created, kind, name, runs, hash, idempotency_key, client, cpu_s_estimated, memory) "
	              "VALUES (?1, 'queued', " NOW ", ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9)",
	[ADD]      = "INSERT INTO document (study, name, content, sha256) "
	              "VALUES (?1, ?2, ?3, " DOCUMENT_DIGEST("?1", "?2", "?3") ")",
	[CANCEL]   = "UPDATE study SET status = 'cancelled', finished = max(" NOW ", coalesce(started, created)) "
	              "WHERE id = ?1 AND status IN ('queued', 'running')",
	[DELETE]   = "DELETE FROM study WHERE id = ?1",
	[CLAIM]    = "UPDATE study SET status = 'running', attempt = attempt + 1, "
	              "started = coalesce(started, max(" NOW ", created)) WHERE id = "
	              "coalesce((" QUEUED "AND ?2 <> '' AND client <> ?2 AND attempt - attempt_kept < 3 ORDER BY id LIMIT 1), "
	              "(" QUEUED "AND attempt - attempt_kept < 3 ORDER BY id LIMIT 1), "
	              "(" QUEUED "ORDER BY id LIMIT 1)) AND memory <= ?1 RETURNING id, memory, cpu_s_estimated, coalesce(client, '')",
	[KEEP]     = "INSERT OR REPLACE INTO block (study, number, attempt, runs, cpu_s, wall_s, content, sha256) "
	              "SELECT id, ?2, attempt, ?3, ?4, ?5, ?6, " BLOCK_DIGEST("?1", "?2", "?6") " "
	              "FROM study WHERE id = ?1 AND status = 'running'",
	[PROGRESS] = "UPDATE study SET " BLOCK_SUMS("max(study.cpu_s, total(block.cpu_s))") ", attempt_kept = attempt WHERE id = ?1",
	[PRUNE]    = "DELETE FROM block WHERE study = ?1 AND sha256 IS NOT " BLOCK_DIGEST("study", "number", "content"),
	[SHED]     = "DELETE FROM block WHERE study = ?1",
	[RECOUNT]  = "UPDATE study SET " BLOCK_SUMS("total(cpu_s)") " WHERE id = ?1",
	[SPENT]    = "UPDATE study SET cpu_s = max(cpu_s, ?2) WHERE id = ?1 AND status = 'running'",
	[FINISH]   = "UPDATE study SET cpu_s = max(cpu_s, ?4), status = ?2, finished = max(" NOW ", started), error = ?3, "
	              "runs = iif(?3 IS NULL AND runs_done > 0, runs_done, runs) WHERE id = ?1 AND status = 'running'",
	[REQUEUE]  = "UPDATE study SET status = 'queued', "
	              "crashes = iif(attempt > attempt_kept, crashes + (id = ?1), 0) WHERE status = 'running'",
	// an orderly stop does not count as a failed attempt
	[STOPPED]  = "UPDATE study SET status = 'queued', attempt = max(attempt_kept, attempt - 1) WHERE status = 'running'",
	[VAIN]     = "UPDATE study SET status = 'failed', finished = max(" NOW ", started), "
	              "error = 'out-of-memory-or-crash: the server ended ten times while it ran this study, before any block was finished' "
	              "WHERE status = 'queued' AND attempt - attempt_kept >= 10",
	[POISON]   = "UPDATE study SET status = 'failed', finished = max(" NOW ", started), "
	              "error = 'poison-study: the server crashed three times while it ran this study' "
	              "WHERE status = 'queued' AND crashes >= 3",
	[REPLACE_RECORD] = "UPDATE record SET created = " NOW ", content = ?2 WHERE sha256 = ?1",
	[ADD_RECORD]     = "INSERT INTO record (sha256, created, content) VALUES (?1, " NOW ", ?2)",
	[NAME_RECORD]    = "INSERT INTO study_record (study, record) SELECT ?1, sha256 FROM record WHERE sha256 = ?2 "
	                    "ON CONFLICT DO UPDATE SET record = excluded.record",
	[FORGET_RECORDS] = "DELETE FROM record WHERE " UNNAMED,
};
// clang-format on
