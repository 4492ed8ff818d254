-- A diagnosis is its document. What stood beside it in columns and rows said the same once more, and nothing read it.
DROP TABLE diagnosis_parameter;
DROP TABLE diagnosis_effect;
DROP TABLE diagnosis_candidate;
ALTER TABLE diagnosis DROP COLUMN base_model;
ALTER TABLE diagnosis DROP COLUMN verdict;
ALTER TABLE diagnosis DROP COLUMN p_misfit;
ALTER TABLE diagnosis DROP COLUMN p_leftover;
