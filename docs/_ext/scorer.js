// Pages come before names: a reader who searches "contact resistance" wants the page of that title.
const LATER = /^(reference\/|notation|auto_gallery\/)/;
var Scorer = {
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 5, 1: 0, 2: -5 },
  objPrioDefault: 0,
  title: 40,
  partialTitle: 15,
  term: 5,
  partialTerm: 2,
  score: (result) => result[4] * (LATER.test(result[0]) ? 0.5 : 1),
};
