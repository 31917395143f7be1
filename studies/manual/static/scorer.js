// How Sphinx orders the results of a search. The numbers but for `score` are those of Sphinx.
// Pages of modules come after all pages that are written for readers.
var Scorer = {
  score: (result) => {
    const [page, , , , score] = result;
    return page.startsWith("reference/api/drumlin.") ? score - 100 : score;
  },
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
