// The three pages of poundd: the list, one study, a new one.  Names enter as text only; no library.
const $ = id => document.getElementById(id);
const sleep = ms => new Promise(done => setTimeout(done, ms));

function element(name, attributes = {}, ...children) {
	const made = document.createElement(name);
	for (const [key, value] of Object.entries(attributes))
		if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
		else if (value !== null && value !== false) made.setAttribute(key, value === true ? "" : value);
	made.append(...children);
	return made;
}

// ---- the server ----

function dialog(text, yes, field = false) {
	const ask = $("ask");
	$("ask-text").textContent = text;
	$("ask-yes").textContent = yes;
	$("ask-field").hidden = !field;
	$("ask-input").value = "";
	ask.showModal();
	(field ? $("ask-input") : $("ask-no")).focus();
	return new Promise(done => {
		const end = answer => { ask.onclose = null; ask.close(); done(answer); };
		$("ask-yes").onclick = () => end(field ? $("ask-input").value.trim() : true);
		$("ask-input").onkeydown = event => { if (event.key === "Enter") $("ask-yes").click(); };
		$("ask-no").onclick = ask.onclose = () => end(null);
	});
}

const headers = (more = {}) => {
	const token = sessionStorage.getItem("token");
	return token ? { ...more, Authorization: `Bearer ${token}` } : more;
};

let asking = null, reached = true;

// A request that is tried again until the server answers; a token is asked for once by all that need one.
async function ask(path, options = {}) {
	for (let pause = 1000; ; pause = Math.min(2 * pause, 10000)) {
		let answer;
		try {
			answer = await fetch(path, { ...options, headers: headers(options.headers) });
		} catch {
			$("server").textContent = "the server does not answer; trying again";
			reached = false;
			await sleep(pause);
			continue;
		}
		if (!reached) $("server").textContent = "the server answers again";
		reached = true;
		if (answer.status === 401) {
			asking ??= dialog(sessionStorage.getItem("token") ? "The server does not know this token." : "This server asks for a token.", "continue", true).finally(() => { asking = null; });
			const token = await asking;
			if (token === null) return answer;
			sessionStorage.setItem("token", token);
			continue;
		}
		if (answer.status !== 503) return answer;
		await sleep(1000 * (Number(answer.headers.get("Retry-After")) || 1));
	}
}

async function reason(answer) {
	try {
		return (await answer.json()).detail ?? answer.statusText;
	} catch {
		return answer.statusText;
	}
}

async function seen() {
	while (document.hidden) await new Promise(done => document.addEventListener("visibilitychange", done, { once: true }));
}

const ended = status => ["succeeded", "failed", "cancelled"].includes(status);
const percent = study => `${Math.floor(100 * study.progress)}\u00a0%`;
const time = text => text ? new Date(text).toLocaleString() : "";

function duration(seconds) {
	const s = Math.ceil(seconds), two = n => String(n).padStart(2, "0");
	return s < 3600 ? `${Math.floor(s / 60)}:${two(s % 60)}` : `${Math.floor(s / 3600)}:${two(Math.floor(s / 60) % 60)}:${two(s % 60)}`;
}

const queued = study => `${study.queue_position === 1 ? "next" : `number ${study.queue_position}`} in the queue, expected to start ${new Date(study.expected_start).toLocaleTimeString()}`;

// ---- the list ----

function listed(study) {
	const active = !ended(study.status);
	const left = study.eta_s === null ? "" : `, ${duration(study.eta_s)} left`;
	// on a narrow screen a row is no row to the browser, unless its role says so
	const cell = (...inside) => element("td", { role: "cell" }, ...inside);
	return element("tr", { role: "row" },
		element("td", { class: "name", role: "cell" }, element("a", { href: `/studies/${study.id}` }, study.name || study.id)),
		cell(study.kind.replaceAll("_", " ")),
		cell(study.status),
		cell(...(active ? [element("progress", { max: 1, value: study.progress, "aria-label": "progress" }), " "] : []),
			!active ? "" : study.queue_position ? queued(study) : percent(study) + left),
		cell(time(study.created)));
}

async function list() {
	const chosen = new URLSearchParams(location.search);
	$("status").value = chosen.get("status") ?? "";
	$("status").onchange = () => { location.search = $("status").value ? `?status=${$("status").value}` : ""; };
	for (let before = null; ; await sleep(3000)) {
		await seen();
		const answer = await ask(`/v1/studies?${chosen}`);
		if (!answer.ok) {
			$("server").textContent = await reason(answer);
			return;
		}
		const text = await answer.text();
		if (text === before) continue;
		before = text;
		const page = JSON.parse(text), focused = document.activeElement?.getAttribute("href");
		$("studies").tBodies[0].replaceChildren(...page.studies.map(listed));
		if (focused?.startsWith("/studies/")) $("studies").querySelector(`a[href="${CSS.escape(focused)}"]`)?.focus();
		$("none").hidden = page.studies.length > 0;
		$("next").hidden = !page.next;
		if (page.next) $("next").href = `?${new URLSearchParams({ ...Object.fromEntries(chosen), cursor: page.next })}`;
		if (!page.studies.some(study => !ended(study.status))) return;
	}
}

// ---- one study ----

const id = location.pathname.split("/").pop();
const base = `/v1/studies/${id}`;

function keep(name, blob) {
	const url = URL.createObjectURL(blob);
	element("a", { href: url, download: name }).click();
	setTimeout(() => URL.revokeObjectURL(url), 10000);
}

// A link, unless a token must go with it.
function download(path, name, label) {
	return element("a", { href: path, download: name, onclick: async event => {
		if (!sessionStorage.getItem("token")) return;
		event.preventDefault();
		const answer = await ask(path);
		if (answer.ok) keep(name, await answer.blob());
		else $("server").textContent = await reason(answer);
	} }, label);
}

async function picture(svg, name) {
	const url = URL.createObjectURL(new Blob([svg], { type: "image/svg+xml" })), image = new Image();
	image.src = url;
	await image.decode();
	const canvas = element("canvas");
	canvas.width = 2 * image.naturalWidth;
	canvas.height = 2 * image.naturalHeight;
	canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
	URL.revokeObjectURL(url);
	canvas.toBlob(blob => keep(name, blob));
}

function cells(line) {
	return [...line.matchAll(/(?:^|,)(?:"((?:[^"]|"")*)"|([^,]*))/g)].map(found => found[1]?.replaceAll('""', '"') ?? found[2]);
}

const ROWS_MOST = 300;

async function table(figure) {
	const answer = await ask(`${base}/results?${figure.table ? `table=${figure.table}` : "format=csv"}`);
	if (!answer.ok) return element("p", {}, await reason(answer));
	const [head, ...rows] = (await answer.text()).trimEnd().split("\r\n").map(cells);
	const shown = head.map((name, k) => [name, k]).filter(([name]) => !/accuracy|_raw|_pick_freeze|^output\.(?!name|frequency)/.test(name));
	const short = text => text !== "" && isFinite(text) ? String(Number(Number(text).toPrecision(5))) : text;
	const made = element("table", {}, element("caption", {}, `${figure.title}${rows.length > ROWS_MOST ? `: the first ${ROWS_MOST} of ${rows.length} rows` : ""}`),
		element("thead", {}, element("tr", {}, ...shown.map(([name]) => element("th", { scope: "col" }, name)))),
		element("tbody", {}, ...rows.slice(0, ROWS_MOST).map(row => element("tr", {}, ...shown.map(([, k]) => element("td", {}, short(row[k] ?? "")))))));
	return element("div", { class: "wide", tabindex: 0, role: "region", "aria-label": figure.title }, made);
}

// Of a figure that fills the page with text as large as the page's, which a reader may have doubled.
function figureWidth() {
	const zoom = parseFloat(getComputedStyle(document.documentElement).fontSize) / 16;
	return Math.max(320, Math.min(1400, Math.floor(($("figures").clientWidth - 20) / zoom / 20) * 20));
}

// One figure with its table and links; parsed as XML, and without its style: the page's own sheet has the colors.
async function figure(row, choice, partial) {
	const query = new URLSearchParams({ width: figureWidth() });
	for (const name of row.arguments) if (choice[name]) query.set(name, choice[name]);
	if (partial) query.set("partial", "true");
	const path = `${row.link}?${query}`, answer = await ask(path), box = element("figure");
	if (!answer.ok) {
		box.append(element("p", {}, `${row.title}: ${await reason(answer)}`));
		return box;
	}
	const svg = await answer.text();
	const parsed = new DOMParser().parseFromString(svg.replace(/<style>[^<]*<\/style>/, ""), "image/svg+xml");
	const drawing = document.importNode(parsed.documentElement, true);
	drawing.setAttribute("aria-label", parsed.querySelector("title")?.textContent ?? row.title);
	const details = element("details", { ontoggle: async () => {
		if (details.open && details.childElementCount === 1) details.append(await table(row));
	} }, element("summary", {}, "table"));
	box.append(drawing, element("figcaption", { class: "row" }, row.title,
		download(path, `${row.name}.svg`, "SVG"),
		element("button", { type: "button", onclick: () => picture(svg, `${row.name}.png`) }, "PNG")));
	if (!partial) box.append(details);
	return box;
}

let latest = 0; // drawing of all figures: what a slower, earlier one brings is not shown

// The figures are drawn while the result, a promise, is still on its way.
async function figures(coming, partial) {
	const answer = await ask(`${base}/figures${partial ? "?partial=true" : ""}`);
	if (!answer.ok) {
		$("server").textContent = await reason(answer);
		return;
	}
	const rows = (await answer.json()).figures, chosen = Object.fromEntries(new URLSearchParams(location.search));
	const draw = async () => {
		const number = ++latest;
		$("figures-section").hidden = false;
		if (!$("figures").childElementCount) $("figures").append(element("p", { class: "muted", role: "status" }, "drawing"));
		const made = await Promise.all(rows.map(row => figure(row, chosen, partial)));
		if (number === latest) $("figures").replaceChildren(...made);
	};
	const drawn = draw(), result = await coming;
	const all = Array.isArray(result?.cells) && result.kind === "sensitivity" ? result.cells : [];
	const names = [...new Set(all.flatMap(cell => cell.outputs.map(output => output.name)))];
	const options = {
		cell: all.length > 1 ? all.map((cell, k) => [k, Object.entries(cell.sweep).map(([path, value]) => `${path.split("/").pop()} ${value}`).join(", ")]) : [],
		output: names.length > 1 ? [["", "all"], ...names.map(name => [name, name])] : [],
		index: all.length ? [["", "default"], ["S1", "S1"], ["ST", "ST"]] : [],
	};
	$("choices").replaceChildren(...Object.entries(options).filter(([, values]) => values.length).map(([name, values]) => {
		const select = element("select", { name, onchange: () => {
			chosen[name] = select.value;
			const query = new URLSearchParams(Object.entries(chosen).filter(([, value]) => value));
			history.replaceState(null, "", `${location.pathname}${query.size ? `?${query}` : ""}`);
			draw();
		} }, ...values.map(([value, text]) => element("option", { value }, String(text))));
		select.value = chosen[name] ?? values[0][0];
		return element("label", {}, `${name} `, select);
	}));
	$("choices").hidden = !$("choices").childElementCount;
	await drawn;
}

function notesOf(value, found = new Map()) {
	if (value && typeof value === "object")
		for (const [key, inside] of Object.entries(value))
			if (key === "note" && typeof inside === "string") found.set(inside, (found.get(inside) ?? 0) + 1);
			else notesOf(inside, found);
	return found;
}

function data(study) {
	const done = study.status === "succeeded";
	const sampled = done && ["sensitivity", "floor_spectrum", "response"].includes(study.kind);
	const links = [["request", `${id}.json`, "the study document"]];
	if (done) links.push(["results", `${id}-result.json`, "the result, JSON"], ["results?format=csv", `${id}.csv`, "the result, CSV"]);
	if (sampled) links.push(["samples?format=csv", `${id}-samples.csv`, "samples, CSV"], ["samples?format=npy", `${id}-samples.npy`, "samples, NumPy"]);
	$("downloads").replaceChildren(...links.map(([rest, name, label]) => element("li", {}, download(`${base}/${rest}`, name, label))));
	// a server that asks for a token gets it from the variable that pound reads, too
	const secret = sessionStorage.getItem("token");
	$("use-shell").textContent = `curl -sS --fail-with-body ${secret ? '-H "Authorization: Bearer $POUND_TOKEN" ' : ""}${location.origin}${base}/results -o result.json\nPOUND_URL=${location.origin} pound report ${id} >report.html`;
	$("use-python").textContent = `import json, ${secret ? "os, " : ""}urllib.request\nurl = "${location.origin}${base}/results"\n${secret ? 'url = urllib.request.Request(url, headers={"Authorization": "Bearer " + os.environ["POUND_TOKEN"]})\n' : ""}result = json.load(urllib.request.urlopen(url))\nprint(result["kind"], list(result))`;
}

let tenth = -1;

function show(study) {
	const running = study.status === "running";
	document.title = `${running ? `${percent(study)} ` : ""}${study.name || study.id} - pound`;
	$("name").textContent = study.name || study.id;
	$("about").textContent = `${study.kind.replaceAll("_", " ")}, ${study.runs_total.toLocaleString("en")} runs, created ${time(study.created)}`;
	$("status").textContent = study.status;
	$("progress").hidden = ended(study.status);
	$("progress").value = study.progress;
	$("left").textContent = running ? `${percent(study)}${study.eta_s === null ? "" : `, ${duration(study.eta_s)} left`}` : study.queue_position ? queued(study) : "";
	$("late").hidden = !study.over_estimate;
	$("late").textContent = study.over_estimate ? `${Math.round(study.cpu_s / study.estimated_cpu_s)} times the estimated CPU time: ${study.cpu_s.toPrecision(2)} s` : "";
	$("error").hidden = !study.error;
	$("error").textContent = study.error ?? "";
	$("cancel").hidden = ended(study.status);
	$("so-far").hidden = !running || study.kind !== "sensitivity";
	$("again").href = `/new?from=${id}`;
	const now = ended(study.status) ? study.status : Math.floor(10 * study.progress);
	if (now !== tenth) $("live").textContent = ended(study.status) ? `the study is ${study.status === "succeeded" ? "finished" : study.status}` : `${study.status}, ${10 * now} percent`;
	tenth = now;
	data(study);
}

const items = texts => texts.map(text => element("li", {}, text));

async function noted(coming) {
	const result = await coming;
	if (!result) return;
	$("warnings").replaceChildren(...items((result.warnings ?? []).map(warning => `${warning.pointer}: ${warning.detail}`)));
	$("warnings-section").hidden = !$("warnings").childElementCount;
	const whole = ["partial", "stopping", "design", "accuracy"].map(part => result[part]?.note).filter(Boolean);
	const others = [...notesOf(result)].filter(([text]) => !whole.includes(text)).map(([text, n]) => n > 1 ? `${text} (${n} times)` : text);
	$("notes").replaceChildren(...items(whole.length ? whole : others.splice(0, 5)));
	$("more-notes").replaceChildren(...items(others));
	$("more").hidden = !others.length;
	$("left-out").replaceChildren(...items(result.work?.left_out ?? []));
	$("notes-section").hidden = false;
}

async function finished() {
	const coming = ask(`${base}/results`).then(answer => answer.ok ? answer.json() : null);
	await Promise.all([noted(coming), figures(coming, false)]);
}

async function study() {
	$("cancel").onclick = async () => {
		if (await dialog("Cancel this study? It cannot be continued.", "cancel the study")) await ask(`${base}/cancel`, { method: "POST" });
	};
	$("delete").onclick = async () => {
		if (!await dialog("Delete this study and its result?", "delete the study")) return;
		const answer = await ask(base, { method: "DELETE" });
		if (answer.ok || answer.status === 404) location.href = "/";
	};
	$("so-far").onclick = () => figures(null, true);
	for (let tag = null; ; ) {
		await seen();
		const answer = await ask(base, { headers: tag ? { "If-None-Match": tag, Prefer: "wait=25" } : {} });
		if (answer.status !== 304 && !answer.ok) {
			$("status").textContent = await reason(answer);
			return;
		}
		if (answer.ok) {
			tag = answer.headers.get("ETag");
			const now = await answer.json();
			show(now);
			if (now.status === "succeeded") await finished();
			if (ended(now.status)) return;
		}
		await sleep(1000);
	}
}

// ---- a new study ----

// Position of a JSON Pointer's value in a text: [start, end], or of the innermost enclosing value that exists.
function place(text, pointer) {
	const parts = pointer.split("/").slice(1).map(part => part.replaceAll("~1", "/").replaceAll("~0", "~"));
	const blank = at => { while (/\s/.test(text[at] ?? "")) at++; return at; };
	const string = at => { at++; while (at < text.length && text[at] !== '"') at += text[at] === "\\" ? 2 : 1; return at + 1; };
	let found = [0, text.length];
	const value = (at, depth, wanted) => {
		const start = at = blank(at), close = { "{": "}", "[": "]" }[text[at]];
		if (!close) {
			if (text[at] === '"') at = string(at);
			else while (at < text.length && !/[,\]}\s]/.test(text[at])) at++;
		} else {
			at = blank(at + 1);
			for (let k = 0; at < text.length && text[at] !== close; k++) {
				let name = String(k);
				if (close === "}") {
					const end = string(at);
					try { name = JSON.parse(text.slice(at, end)); } catch { name = ""; }
					at = blank(blank(end) + 1);
				}
				const next = value(at, depth + 1, wanted && name === parts[depth]);
				at = blank(Math.max(next, at + 1));
				if (text[at] === ",") at = blank(at + 1);
			}
			at++;
		}
		if (wanted && depth > (found.depth ?? -1)) found = Object.assign([start, at], { depth });
		return at;
	};
	value(0, 0, true);
	return found;
}

function fault(problem) {
	const text = $("text");
	return element("li", {}, element("button", { type: "button", onclick: () => {
		const [start, end] = problem.line ? lineAt(text.value, problem.line, problem.column) : place(text.value, problem.pointer);
		text.focus();
		text.setSelectionRange(start, end);
		text.scrollTop = (text.value.slice(0, start).split("\n").length - 5) * parseFloat(getComputedStyle(text).lineHeight);
	} }, `${problem.pointer || (problem.line ? `line ${problem.line}, column ${problem.column}` : "document")}: ${problem.detail}`));
}

function lineAt(text, line, column) {
	const start = text.split("\n").slice(0, line - 1).join("\n").length + (line > 1) + column - 1;
	return [start, start + 1];
}

const size = bytes => bytes < 1e6 ? `${Math.ceil(bytes / 1e3)} kB` : `${Math.ceil(bytes / 1e6)} MB`;

async function judge(number) {
	const text = $("text").value;
	const answer = await ask("/v1/studies?validate_only=true", { method: "POST", body: text, headers: { "Content-Type": "application/json" } });
	if (number !== judge.number) return;
	const reply = await answer.json().catch(() => ({ detail: answer.statusText }));
	$("submit").disabled = !answer.ok;
	$("verdict").className = answer.ok ? "" : "fault";
	$("verdict").textContent = answer.ok
		? `valid: ${reply.runs_total.toLocaleString("en")} runs, about ${Number(reply.estimated_cpu_s.toPrecision(2)).toLocaleString("en")} s of one core, ${size(reply.estimated_bytes)} stored, ${size(reply.estimated_memory_bytes)} of memory${reply.warnings ? "; warnings, each a button that leads to its place:" : ""}`
		: `${reply.errors ? "errors, each a button that leads to its place:" : reply.detail}${reply.errors_not_listed ? `, and ${reply.errors_not_listed} more` : ""}`;
	const problems = (answer.ok ? reply.warnings : reply.errors) ?? (reply.line ? [{ pointer: "", ...reply }] : []);
	$("faults").replaceChildren(...problems.map(problem => fault(reply.line ? { ...problem, line: reply.line, column: reply.column } : problem)));
}
judge.number = 0;

function changed() {
	localStorage.setItem("draft", $("text").value);
	$("submit").disabled = true;
	const number = ++judge.number;
	setTimeout(() => { if (number === judge.number && $("text").value.trim()) judge(number); }, 400);
}

async function fill(path) {
	const answer = await ask(path);
	if (answer.ok) $("text").value = await answer.text();
	else $("verdict").textContent = await reason(answer);
	changed();
}

function key() {
	return [...crypto.getRandomValues(new Uint8Array(16))].map(byte => byte.toString(16).padStart(2, "0")).join("");
}

async function make() {
	const text = $("text"), from = new URLSearchParams(location.search).get("from");
	text.oninput = changed;
	const take = async file => { if (file) { text.value = await file.text(); changed(); } };
	$("file").onchange = () => take($("file").files[0]);
	text.ondragover = event => event.preventDefault();
	text.ondrop = event => { if (event.dataTransfer.files.length) { event.preventDefault(); take(event.dataTransfer.files[0]); } };
	$("example").onchange = () => { if ($("example").value) fill(`/v1/examples/${$("example").value}`); };
	$("submit").onclick = async () => {
		$("submit").disabled = true;
		const answer = await ask("/v1/studies", { method: "POST", body: text.value, headers: { "Content-Type": "application/json", "Idempotency-Key": key() } });
		if (answer.status === 201) {
			localStorage.removeItem("draft");
			location.href = `/studies/${(await answer.json()).id}`;
		} else {
			$("verdict").className = "fault";
			$("verdict").textContent = await reason(answer);
			$("submit").disabled = false;
		}
	};
	if (/^[0-9a-f]{16}$/.test(from ?? "")) await fill(`/v1/studies/${from}/request`);
	else if (localStorage.getItem("draft")) {
		text.value = localStorage.getItem("draft");
		changed();
	}
	const answer = await ask("/v1/examples");
	if (answer.ok)
		$("example").append(...(await answer.json()).examples.map(one => element("option", { value: one.name }, one.title)));
}

fetch("/version", { headers: headers() }).then(async answer => {
	if (answer.ok && reached) $("server").textContent = `poundd ${(await answer.json()).version}`;
}).catch(() => {});
await { list, study, new: make }[document.body.dataset.page]();
