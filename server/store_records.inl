/* Files of recorded ground motions in the store.  Included by server/store.c, before store_submit. */

enum { UNNAMED_MS = 3600 * 1000 /* for which a record that no study names is kept */ };

/* Stores a file; it is on the disk when this returns.
 *
 * Given    sha256    of content, hexadecimal
 *          content   (length) bytes
 * Status   STORE_REPEATED   it was stored already
 *          STORE_FULL       the disk has no space for it
 * Test     service_records: a_record_lives_while_a_study_names_it
 */
enum store_status store_put_record(struct store *store, const char *sha256, const char *content,
                                   size_t length)
{
	const bool has_room = roomy(store);
	struct database *c = writer(store);
	enum store_status status = run(c, bound(c, REPLACE_RECORD, "tb", sha256, content, length), NULL);
	const bool known = status == STORE_OK;
	if (status == STORE_NONE)
		status = has_room ? run(c, bound(c, ADD_RECORD, "tb", sha256, content, length), NULL) : STORE_FULL;
	status = changed(store, 0, status);
	return status == STORE_OK && known ? STORE_REPEATED : status;
}

/* Reads a file.
 *
 * Returns  content   (length) bytes, and a zero behind them; allocated when STORE_OK
 * Status   STORE_NONE      no file has this SHA-256
 *          STORE_CORRUPT   these are not the bytes that were stored
 */
enum store_status store_record(struct store *store, const char *sha256, char **content, size_t *length)
{
	char place[80];
	snprintf(place, sizeof place, "record %.64s", sha256);
	struct database *c = reader(store);
	return content_of(c, bound(c, RECORD, "t", sha256), place, content, length);
}

/* Adds a study, its document and its references to records in one transaction. */
static enum store_status study_add(struct database *c, const struct store_study *study, int64_t id,
                                   const char *request, size_t length)
{
	enum store_status status = run(c, bound(c, BEGIN, ""), NULL);
	if (status != STORE_FAILED)
		status = run(c,
		             bound(c, SUBMIT, "ittitttdi", id, study->kind, study->name, study->runs, study->hash,
		                   study->key, study->client, study->cpu_s, study->memory),
		             NULL);
	if (status == STORE_OK)
		status = run(c, bound(c, ADD, "itb", id, "request", request, length), NULL);
	for (int k = 0; k < study->n_records && status == STORE_OK; k++)
		status = run(c, bound(c, NAME_RECORD, "it", id, study->records[k]), NULL);
	return committed(c, status == STORE_NONE ? STORE_UNRECORDED : status);
}

/* Deletes records that no study names and that were sent more than UNNAMED_MS ago. */
static void records_expire(struct store *store)
{
	struct database *c = reader(store);
	if (released(c, run(c, bound(c, RECORDS_EXPIRED, "i", (int64_t)UNNAMED_MS), NULL)) != STORE_OK)
		return;
	c = writer(store);
	changed(store, 0, run(c, bound(c, FORGET_RECORDS, "i", (int64_t)UNNAMED_MS), NULL));
}
