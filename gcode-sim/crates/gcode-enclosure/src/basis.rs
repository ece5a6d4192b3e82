//! Monomials of the variables of a box, numbered as they appear.
use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, Mutex, PoisonError};

/// Largest number of variables: four bits of a key each.
pub(crate) const MAX_VARIABLES: usize = 16;
/// Largest total degree: that of one variable fits four bits.
pub(crate) const MAX_DEGREE: u32 = 12;

/// Numbers monomials up to a total degree and remembers their products.
///
/// Every variable lies in [−1, 1]. Monomial 0 is the constant 1.
#[derive(Clone, Debug)]
pub(crate) struct Basis {
    tables: Arc<Tables>,
    /// Sums by monomial, 0 between two uses.
    scratch: Vec<f64>,
}

/// Monomials and their products, shared by the bases of equal boxes until one needs more.
#[derive(Clone, Debug)]
struct Tables {
    degree: u32,
    /// Variables that count as several: their products with others soon lie beyond the degree.
    heavy: u32,
    keys: Vec<u64>,
    index: HashMap<u64, u32>,
    products: Vec<Vec<u32>>,
    /// Number of monomials whose products with one another are all known.
    complete: usize,
}

/// Tables by number of variables and degree, with all their monomials.
static COMPLETE: Mutex<BTreeMap<(usize, u32), Arc<Tables>>> = Mutex::new(BTreeMap::new());

/// A product that hasn't been looked up.
const UNKNOWN: u32 = u32::MAX;
/// A product beyond the degree with an odd exponent, in [−1, 1].
const BEYOND_ODD: u32 = u32::MAX - 1;
/// A product beyond the degree with even exponents only, in [0, 1].
const BEYOND_EVEN: u32 = u32::MAX - 2;

const ODD_BITS: u64 = 0x1111_1111_1111_1111;

impl Basis {
    /// Returns the basis of some variables up to a degree; others may join.
    pub(crate) fn new(variables: usize, degree: u32) -> Self {
        let degree = degree.min(MAX_DEGREE);
        let mut complete = COMPLETE.lock().unwrap_or_else(PoisonError::into_inner);
        let tables =
            complete.entry((variables, degree)).or_insert_with(|| Arc::new(Tables::new(variables, degree)));
        Self { tables: Arc::clone(tables), scratch: Vec::new() }
    }

    pub(crate) fn degree(&self) -> u32 {
        self.tables.degree
    }

    /// Returns the monomial that is one variable.
    pub(crate) fn variable(&mut self, variable: usize) -> u32 {
        let key = 1 << (4 * variable);
        match self.tables.index.get(&key) {
            Some(known) => *known,
            None => Arc::make_mut(&mut self.tables).intern(key),
        }
    }

    /// Lets a new variable count as half the degree: few monomials have it.
    pub(crate) fn make_heavy(&mut self, variable: usize) {
        Arc::make_mut(&mut self.tables).heavy |= 1 << variable;
    }

    /// Returns true for the monomial that is one variable.
    pub(crate) fn is_variable(&self, monomial: u32, variable: usize) -> bool {
        self.tables.keys[monomial as usize] == 1 << (4 * variable)
    }

    /// Returns a monomial that has a variable, divided by it.
    pub(crate) fn divided(&mut self, monomial: u32, variable: usize) -> u32 {
        let key = self.tables.keys[monomial as usize] - (1 << (4 * variable));
        match self.tables.index.get(&key) {
            Some(known) => *known,
            None => Arc::make_mut(&mut self.tables).intern(key),
        }
    }

    /// Returns the exponent of a variable in a monomial.
    pub(crate) fn exponent(&self, monomial: u32, variable: usize) -> u32 {
        (self.tables.keys[monomial as usize] >> (4 * variable) & 15) as u32
    }

    /// Returns true for a monomial with even exponents only: it lies in [0, 1].
    pub(crate) fn is_even(&self, monomial: u32) -> bool {
        self.tables.keys[monomial as usize] & ODD_BITS == 0
    }

    /// Returns the product of two polynomials up to the degree, and what lies beyond.
    pub(crate) fn multiply(&mut self, left: &[(u32, f64)], right: &[(u32, f64)]) -> Product {
        let mut beyond = Product::default();
        self.complete_for(left, right);
        let tables = &*self.tables;
        self.scratch.resize(tables.keys.len(), 0.0);
        let scratch = self.scratch.as_mut_slice();
        for &(a, x) in left {
            let row = tables.products[a as usize].as_slice();
            for &(b, y) in right {
                let value = x * y;
                match row[b as usize] {
                    BEYOND_ODD => beyond.odd += value.abs(),
                    BEYOND_EVEN if value > 0.0 => beyond.positive += value,
                    BEYOND_EVEN => beyond.negative -= value,
                    monomial => scratch[monomial as usize] += value,
                }
            }
        }
        // Products with even exponents lie on one side: the polynomial takes the middle.
        scratch[0] += (beyond.positive - beyond.negative) / 2.0;
        for (monomial, sum) in scratch.iter_mut().enumerate() {
            if *sum != 0.0 {
                beyond.terms.push((monomial as u32, std::mem::take(sum)));
            }
        }
        beyond
    }

    /// Looks all products of monomials of two polynomials up.
    fn complete_for(&mut self, left: &[(u32, f64)], right: &[(u32, f64)]) {
        let last = |terms: &[(u32, f64)]| terms.last().map_or(0, |(monomial, _)| *monomial as usize);
        if last(left).max(last(right)) < self.tables.complete {
            return;
        }
        for &(a, _) in left {
            for &(b, _) in right {
                let known = self.tables.products[a as usize].get(b as usize);
                if known.is_none_or(|product| *product == UNKNOWN) {
                    Arc::make_mut(&mut self.tables).find_product(a, b);
                }
            }
        }
    }
}

/// A product of polynomials.
#[derive(Debug, Default)]
pub(crate) struct Product {
    /// Its terms up to the degree.
    pub(crate) terms: Vec<(u32, f64)>,
    /// Sum of the magnitudes of terms beyond the degree with an odd exponent, in [−1, 1].
    pub(crate) odd: f64,
    /// Sum of the positive coefficients beyond the degree with even exponents only, in [0, 1].
    pub(crate) positive: f64,
    /// Sum of the magnitudes of the negative ones.
    pub(crate) negative: f64,
}

impl Tables {
    /// Returns the tables of all monomials of some variables up to a degree.
    fn new(variables: usize, degree: u32) -> Self {
        let mut tables = Self {
            degree,
            heavy: 0,
            keys: Vec::new(),
            index: HashMap::new(),
            products: Vec::new(),
            complete: 0,
        };
        tables.intern(0);
        for variable in (0..variables).filter(|_| degree > 0) {
            tables.intern(1 << (4 * variable));
        }
        // A monomial × a variable is a monomial of the next degree.
        let mut next = 0;
        while next < tables.keys.len() {
            for variable in 0..variables.min(tables.keys.len() - 1) {
                tables.find_product(next as u32, variable as u32 + 1);
            }
            next += 1;
        }
        for a in 0..tables.keys.len() as u32 {
            for b in 0..tables.keys.len() as u32 {
                tables.find_product(a, b);
            }
        }
        tables.complete = tables.keys.len();
        tables
    }

    fn find_product(&mut self, a: u32, b: u32) -> u32 {
        let (left, right) = (self.keys[a as usize], self.keys[b as usize]);
        let product = if self.total_degree(left) + self.total_degree(right) <= self.degree {
            self.intern(left + right)
        } else if (left ^ right) & ODD_BITS == 0 {
            BEYOND_EVEN
        } else {
            BEYOND_ODD
        };
        let row = &mut self.products[a as usize];
        if row.len() <= b as usize {
            row.resize(b as usize + 1, UNKNOWN);
        }
        row[b as usize] = product;
        product
    }

    fn intern(&mut self, key: u64) -> u32 {
        if let Some(&known) = self.index.get(&key) {
            return known;
        }
        let monomial = self.keys.len() as u32;
        self.keys.push(key);
        self.index.insert(key, monomial);
        self.products.push(Vec::new());
        monomial
    }

    /// Returns the sum of the exponents of a key, of heavy variables as often as they count.
    fn total_degree(&self, key: u64) -> u32 {
        let of_heavy = (self.degree / 2).max(1);
        let degree = |variable: usize| {
            let exponent = (key >> (4 * variable) & 15) as u32;
            if self.heavy >> variable & 1 == 1 { exponent * of_heavy } else { exponent }
        };
        (0..MAX_VARIABLES).map(degree).sum()
    }
}
